"""Reads JSON (RFC 8259), and keeps the line and the path of each value for messages."""
import math
import re
from fractions import Fraction

U = Fraction(1, 2**53)
TINY = Fraction(1, 2**1000)  # more than the underflow of any step


class Unreadable(Exception):
    """The file is no explanation."""


class Wrong(Exception):
    """A line of the explanation is wrong."""


class Value:
    """A value of the file: a dict, a list, a word, True, False, None, or a number as it is written."""

    def __init__(self, line, path):
        self.line, self.path, self.data = line, path, None

    def __getitem__(self, key):
        if isinstance(key, int):
            if not isinstance(self.data, list) or not 0 <= key < len(self.data):
                raise Unreadable(self.at(f"has no element {key}"))
        elif not isinstance(self.data, dict) or key not in self.data:
            raise Unreadable(self.at(f'has no member "{key}"'))
        return self.data[key]

    def __contains__(self, key):
        return isinstance(self.data, dict) and key in self.data

    def __iter__(self):
        if not isinstance(self.data, list):
            raise Unreadable(self.at("must be a list"))
        return iter(self.data)

    def __len__(self):
        return len(list(iter(self)))

    def at(self, what):
        return f"{self.line}: {self.path or 'the file'} {what}"

    def is_null(self):
        return self.data is None

    def word(self):
        if not isinstance(self.data, str):
            raise Unreadable(self.at("must be a word"))
        return self.data

    def truth(self):
        if not isinstance(self.data, bool):
            raise Unreadable(self.at("must be true or false"))
        return self.data

    def number(self):
        """Returns the double that is written, exactly."""
        if not isinstance(self.data, Fraction):
            raise Unreadable(self.at("must be a finite number"))
        return self.data

    def parameter(self):
        """Returns a parameter t of a march: a number, or the sum of two if it lies between two doubles."""
        return sum(self.vector(2)) if isinstance(self.data, list) else self.number()

    def whole(self):
        if self.number().denominator != 1:
            raise Unreadable(self.at("must be a whole number"))
        return int(self.number())

    def word_of_64(self):
        """Returns a whole number below 2^64, which a double may not hold."""
        if not self.number() >= 0 or not self.digits.isdigit() or int(self.digits) >= 2**64:
            raise Unreadable(self.at("must be a whole number from 0 to 2^64 - 1"))
        return int(self.digits)

    def index(self, count):
        """Returns the number as an index of something that has so many elements."""
        if not 0 <= self.whole() < count:
            raise Wrong(self.at(f"is {self.whole()}, and must be from 0 to {count - 1}"))
        return self.whole()

    def vector(self, size=3):
        if len(self) != size:
            raise Unreadable(self.at(f"must have {size} numbers"))
        return [x.number() for x in self]

    def numbers(self):
        return [x.number() for x in self]

    # Checks.

    def refuse(self, found, right):
        raise Wrong(self.at(f"is {shown(found)}, and must be {shown(right)}"))

    def must_be(self, right):
        """Checks a whole number, a word, or that there is none."""
        if right is None and not self.is_null():
            raise Wrong(self.at("must be null"))
        found = self.data if isinstance(right, str) or self.data is None else self.whole()
        if found != right:
            self.refuse(found, right)

    def must_be_near(self, right, error):
        if abs(self.number() - right) > error + TINY:
            self.refuse(self.number(), right)

    def must_be_near_vector(self, right, errors):
        self.vector(len(right))
        for i, x in enumerate(self):
            x.must_be_near(right[i], errors[i] if isinstance(errors, list) else errors)

    def must_equal(self, right):
        self.vector(len(right))
        for x, y in zip(self, right):
            if x.number() != y:
                x.refuse(x.number(), y)

    def must_agree(self, other, but=()):
        """Checks that this is as another value of the file, but for members of these names."""
        if type(self.data) is not type(other.data) or \
                isinstance(self.data, (dict, list)) and len(self.data) != len(other.data):
            raise Wrong(self.at(f"is not as in line {other.line}"))
        if isinstance(self.data, dict):
            for name, value in self.data.items():
                if name not in but:
                    value.must_agree(other[name], but)
        elif isinstance(self.data, list):
            for mine, its in zip(self.data, other.data):
                mine.must_agree(its, but)
        elif self.data != other.data:
            self.refuse(self.data, other.data)


def shown(x):
    if isinstance(x, Fraction):
        return repr(float(x)) if abs(x) < 2**1023 else str(x)
    return "[" + ", ".join(map(shown, x)) + "]" if isinstance(x, list) else repr(x)


class Reader:
    """A reader of JSON (RFC 8259)."""

    token = re.compile(r'[ \t\r\n]*(?:("(?:[^"\\\x00-\x1f]|\\.)*")|(-?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][-+]?\d+)?)|'
                       r"(true|false|null)|([{}\[\],:]))")

    def __init__(self, text):
        self.text, self.at = text, 0
        self.counted, self.lines = 0, 1  # the line of a place, from which others are counted

    def next(self):
        match = self.token.match(self.text, self.at)
        if not match:
            raise Unreadable(f"{self.line()}: no JSON")
        self.at = match.end()
        self.start = match.start(match.lastindex)
        return match

    def line(self):
        between = self.text.count("\n", min(self.counted, self.at), max(self.counted, self.at))
        self.lines += between if self.at > self.counted else -between
        self.counted = self.at
        return self.lines

    def sign(self, *signs):
        match = self.next()
        if match[4] not in signs:
            raise Unreadable(f"{self.line()}: no JSON")
        return match[4]

    def value(self, path=""):
        match = self.next()
        value = Value(self.line(), path)
        if match[1] is not None:
            value.data = match[1][1:-1]
        elif match[2] is not None:
            number = float(match[2])
            if math.isinf(number):
                raise Unreadable(f"{self.line()}: {path} is too large")
            value.data = Fraction(number)
            value.digits = match[2]
        elif match[3] is not None:
            value.data = {"true": True, "false": False, "null": None}[match[3]]
        elif match[4] == "[":
            value.data = []
            if not self.ends("]"):
                value.data.append(self.value(f"{path}/0"))
                while self.sign(",", "]") == ",":
                    value.data.append(self.value(f"{path}/{len(value.data)}"))
        elif match[4] == "{":
            value.data = {}
            if not self.ends("}"):
                self.member(value.data, path)
                while self.sign(",", "}") == ",":
                    self.member(value.data, path)
        else:
            raise Unreadable(f"{self.line()}: no JSON")
        return value

    def member(self, members, path):
        name = self.next()[1]
        if name is None or name[1:-1] in members:
            raise Unreadable(f"{self.line()}: no JSON")
        self.sign(":")
        members[name[1:-1]] = self.value(f"{path}/{name[1:-1]}")

    def ends(self, sign):
        before = self.at
        if self.next()[4] == sign:
            return True
        self.at = before
        return False

    def all(self):
        value = self.value()
        if self.text[self.at:].strip():
            raise Unreadable(f"{self.line()}: text after the end")
        return value
