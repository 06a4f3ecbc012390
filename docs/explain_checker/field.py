"""Fields of marched surfaces, evaluated over intervals: whole numbers count 2^-DIGITS, and all ends are rounded outward.

A field is a list of operations, each of which takes the results of some before it. Evaluated along a line, each result has
an interval of values over a segment, and one of slopes: all derivatives lie in it, and so do all quotients of differences,
also across kinks. Hence a mean value bounds the values as well, f(t) ∈ f(m) + slopes · (t − m).
"""
import math
from fractions import Fraction

from .exact import length, sizes
from .functions import decimal, exponential, sine_and_cosine
from .values import U, Wrong

DIGITS = 170
ONE = 1 << DIGITS
HUGE = 1 << DIGITS + 2000  # stands for infinity
LOST = 1 << DIGITS - 120  # more than the error of a function of functions.py
DEPTH = 60  # how often a segment is halved before its proof is given up


def outward(x):
    """Returns the interval of a fraction."""
    low = x.numerator * ONE // x.denominator
    return low, low if low * x.denominator == x.numerator * ONE else low + 1


def fraction(k):
    return Fraction(k, ONE)


def negative(a):
    return -a[1], -a[0]


def added(a, b):
    return a[0] + b[0], a[1] + b[1]


def multiplied(a, b):
    if a == (0, 0) or b == (0, 0):
        return 0, 0
    products = a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]
    return limited(min(products) >> DIGITS, -(-max(products) >> DIGITS))


def limited(low, high):
    return max(low, -HUGE), min(high, HUGE)


def divided(a, b):
    if b[0] <= 0 <= b[1]:
        return (0, 0) if a == (0, 0) else (-HUGE, HUGE)
    quotients = [(x << DIGITS) // y for x in a for y in b]
    return limited(min(quotients), max(quotients) + 1)


def root_of(a):
    high = max(a[1], 0) << DIGITS
    most = math.isqrt(high)
    return math.isqrt(max(a[0], 0) << DIGITS), most + (most * most < high)


def hull(a, b):
    return min(a[0], b[0]), max(a[1], b[1])


def common(a, b):
    return max(a[0], b[0]), min(a[1], b[1])


def smaller(a, b):
    return min(a[0], b[0]), min(a[1], b[1])


def size_of(a):
    """Returns the interval of magnitudes."""
    return (0 if a[0] <= 0 <= a[1] else min(abs(a[0]), abs(a[1]))), max(abs(a[0]), abs(a[1]))


def function_at(k, f, error):
    """Returns the interval of a function that is known to an error, at a number."""
    low, high = outward(f(fraction(k)))
    return low - error(low), high + error(high)


ZERO = 0, 0


class Operations:
    """The operations: each takes pairs of values and slopes, and returns such a pair. Slopes are lists, one interval for
    each variable."""

    @staticmethod
    def minus(number, a):
        return negative(a[0]), [negative(s) for s in a[1]]

    @staticmethod
    def sum(number, a, b):
        return added(a[0], b[0]), [added(s, t) for s, t in zip(a[1], b[1])]

    @staticmethod
    def difference(number, a, b):
        return Operations.sum(number, a, Operations.minus(number, b))

    @staticmethod
    def product(number, a, b):
        return multiplied(a[0], b[0]), [added(multiplied(s, b[0]), multiplied(t, a[0])) for s, t in zip(a[1], b[1])]

    @staticmethod
    def square(number, a):
        low, high = size_of(a[0])
        return (low * low >> DIGITS, -(-high * high >> DIGITS)), \
            [multiplied(s, (2 * a[0][0], 2 * a[0][1])) for s in a[1]]

    @staticmethod
    def quotient(number, a, b):
        value = divided(a[0], b[0])
        return value, [divided(added(s, negative(multiplied(value, t))), b[0]) for s, t in zip(a[1], b[1])]

    @staticmethod
    def min(number, a, b):
        if a[0][1] < b[0][0]:
            return a
        if b[0][1] < a[0][0]:
            return b
        return smaller(a[0], b[0]), [hull(s, t) for s, t in zip(a[1], b[1])]

    @staticmethod
    def max(number, a, b):
        return Operations.minus(number, Operations.min(number, Operations.minus(number, a), Operations.minus(number, b)))

    @staticmethod
    def abs(number, a):
        return size_of(a[0]), Operations.max(number, a, Operations.minus(number, a))[1]

    @staticmethod
    def sqrt(number, a):
        value = root_of(a[0])
        return value, [divided(s, (2 * value[0], 2 * value[1])) for s in a[1]]

    @staticmethod
    def length(number, *of):
        squares = [Operations.square(number, one) for one in of]
        value = root_of((sum(x[0][0] for x in squares), sum(x[0][1] for x in squares)))
        slopes = []
        for k in range(len(of[0][1])):
            total = ZERO
            for v, s in of:
                total = added(total, multiplied(v, s[k]))
            # It changes no faster than the vector, whose length that is. It falls nowhere if v · v' is nowhere below 0, and
            # rises nowhere if that is nowhere above 0, also where the length is 0: it is 0 there alone, or all around.
            most = root_of((0, sum(-(-size_of(s[k])[1]**2 >> DIGITS) for _, s in of)))[1]
            limits = 0 if total[0] >= 0 else -most, 0 if total[1] <= 0 else most
            slopes.append(common(divided(total, value), limits))
        return value, slopes

    @staticmethod
    def fold(number, a):
        low, high = a[0]
        first, last = low // ONE, high // ONE
        even = lambda k: abs(k - 2 * ((k + ONE) // (2 * ONE)) * ONE)  # the distance from the nearest even number
        ends = sorted((even(low), even(high)))
        if last > first:  # an integer is between
            whole = range(first + 1, min(last, first + 2) + 1)
            ends = [0 if any(k % 2 == 0 for k in whole) else ends[0], ONE if any(k % 2 for k in whole) else ends[1]]
            return (ends[0], ends[1]), [hull(s, negative(s)) for s in a[1]]
        return (ends[0], ends[1]), [s if first % 2 == 0 else negative(s) for s in a[1]]

    @staticmethod
    def wrap(number, a):
        """Returns the difference from the nearest integer. Where it jumps, the field as a whole does not."""
        first, last = ((x + ONE // 2) // ONE for x in a[0])
        value = (a[0][0] - first * ONE, a[0][1] - first * ONE) if first == last else (-ONE // 2, ONE // 2)
        return value, a[1]

    @staticmethod
    def waves(a, quarter):
        """Returns the sine, or the cosine a quarter turn before it."""
        half_pi = Fraction(round(Fraction("1.5707963267948966192313216916397514420985846996875529104874722961") * 2**200),
                           2**200)
        ends = [function_at(k, lambda x: sine_and_cosine(x)[quarter], lambda _: LOST) for k in a[0]]
        low, high = min(x[0] for x in ends), max(x[1] for x in ends)
        # The sine is 1 at π/2 + 2kπ, and −1 half a turn later.
        turns = [(fraction(k) / half_pi + quarter - 1) / 4 for k in a[0]]
        near = Fraction(1, 2**100)
        if math.floor(turns[1] + near) >= math.ceil(turns[0] - near):
            high = ONE
        if math.floor(turns[1] - Fraction(1, 2) + near) >= math.ceil(turns[0] - Fraction(1, 2) - near):
            low = -ONE
        return max(low, -ONE), min(high, ONE)

    @staticmethod
    def sin(number, a):
        slope = Operations.waves(a, 1)
        return Operations.waves(a, 0), [multiplied(slope, s) for s in a[1]]

    @staticmethod
    def cos(number, a):
        slope = negative(Operations.waves(a, 0))
        return Operations.waves(a, 1), [multiplied(slope, s) for s in a[1]]

    @staticmethod
    def exp(number, a):
        part = lambda x: (abs(x) >> 120) + 1
        value = function_at(a[0][0], exponential, part)[0], function_at(a[0][1], exponential, part)[1]
        value = max(value[0], 0), value[1]
        return value, [multiplied(value, s) for s in a[1]]

    @staticmethod
    def log(number, a):
        if a[0][0] <= 0:
            return (-HUGE, HUGE), [(-HUGE, HUGE) for _ in a[1]]
        ln = lambda x: Fraction(decimal(x).ln())
        value = tuple(function_at(k, ln, lambda _: ONE >> 60)[i] for i, k in enumerate(a[0]))
        return value, [divided(s, a[0]) for s in a[1]]

    @staticmethod
    def smooth_min(number, a, b):
        """Returns min(a, b) − h²/(4w), h = max(w − |a − b|, 0). It changes as b by the share s, and as a by the rest."""
        zero = [ZERO for _ in a[1]]
        width, (value_a, value_b) = outward(number), (a[0], b[0])
        apart = Operations.abs(None, ((added(value_a, negative(value_b))), zero))[0]
        h = added(width, negative(apart))
        h = max(h[0], 0), max(h[1], 0)
        drop = divided(multiplied(h, h), (4 * width[0], 4 * width[1]))
        value = added(smaller(value_a, value_b), negative(drop))
        share = divided(added(added(value_a, negative(value_b)), width), (2 * width[0], 2 * width[1]))
        share = min(max(share[0], 0), ONE), max(min(share[1], ONE), 0)
        rest = ONE - share[1], ONE - share[0]
        slopes = [common(hull(s, t), added(multiplied(s, rest), multiplied(t, share))) for s, t in zip(a[1], b[1])]
        return value, slopes


COUNTS = {"minus": 1, "sum": 2, "difference": 2, "product": 2, "quotient": 2, "min": 2, "max": 2, "abs": 1, "square": 1,
          "sqrt": 1, "fold": 1, "wrap": 1, "sin": 1, "cos": 1, "exp": 1, "log": 1, "smooth_min": 2}


class Field:
    """A field, as the list of its operations."""

    def __init__(self, operations):
        self.operations = []
        for i, one in enumerate(operations):
            name = one["type"].word()
            of = [] if "of" not in one else list(one["of"]) if isinstance(one["of"].data, list) else [one["of"]]
            indices = [k.index(i) for k in of]
            number = one["number"].number() if "number" in one else None
            right = 0 if name in ("x", "y", "z", "constant") else 1 if name == "result" else COUNTS.get(name)
            if right is None and name != "length":
                raise Wrong(one["type"].at(f"is {name!r}, which is no operation of a field"))
            if (right is not None and len(indices) != right) or (name == "length" and not indices):
                raise Wrong(one.at(f"must take the results of {right} operations"))
            if (number is None) == (name in ("constant", "smooth_min")) or (name == "smooth_min" and number <= 0):
                raise Wrong(one.at("must have a number if it is a constant or a smooth minimum, and only then"))
            self.operations.append((name, indices, number))
        if not self.operations or self.operations[-1][0] != "result":
            raise Wrong(operations.at("must end with the result"))

    def over(self, point):
        """Returns values and slopes over intervals of the three coordinates, each with its slopes."""
        count, results = len(point[0][1]), []
        for name, of, number in self.operations:
            if name in ("x", "y", "z"):
                result = point["xyz".index(name)]
            elif name == "constant":
                result = outward(number), [ZERO] * count
            elif name == "result":
                result = results[of[0]]
            else:
                result = getattr(Operations, name)(number, *(results[k] for k in of))
            results.append(result)
        return results[-1]

    def gradient(self, point, near):
        """Returns the intervals of the partial derivatives in a cube around a point."""
        axes = [[(ONE, ONE) if i == k else ZERO for i in range(3)] for k in range(3)]
        around = outward(near)[1]
        return self.over([((outward(x)[0] - around, outward(x)[1] + around), axis) for x, axis in zip(point, axes)])[1]


class FieldAlong:
    """A field along a line, less its value at the start if the line leaves the surface."""

    def __init__(self, field, line, leaves):
        self.field, self.line = field, line
        self.level = ZERO
        if leaves:
            self.level = self.over(Fraction(0), Fraction(0))[0]

    def over(self, a, b):
        """Returns the intervals of values and slopes over a segment."""
        t = outward(a)[0], outward(b)[1]
        point = []
        for o, d in zip(self.line.origin, self.line.direction):
            along = outward(d)
            point.append((added(outward(o), multiplied(t, along)), [along]))
        value, slopes = self.field.over(point)
        return added(value, negative(self.level)), slopes[0]

    def value(self, t):
        return self.over(t, t)[0]

    def sign(self, t):
        """Returns the sign of the value at t; 0 if it is not certain."""
        low, high = self.value(t)
        return 1 if low > 0 else -1 if high < 0 else 0

    def is_free(self, a, b, depth=DEPTH):
        """Proves that the field is not 0 in a segment."""
        value, slope = self.over(a, b)
        if value[0] > 0 or value[1] < 0:
            return True
        middle = (a + b) / 2
        half = outward((b - a) / 2)[1]
        by_mean = added(self.value(middle), multiplied(slope, (-half, half)))
        if by_mean[0] > 0 or by_mean[1] < 0:
            return True
        if (slope[0] >= 0 or slope[1] <= 0) and self.sign(a) * self.sign(b) > 0:
            return True
        return depth > 0 and self.is_free(a, middle, depth - 1) and self.is_free(middle, b, depth - 1)

    def has_one_slope(self, a, b, depth=20):
        """Returns the sign of all slopes in a segment; 0 if they have none for certain."""
        low, high = self.over(a, b)[1]
        if low >= 0 or high <= 0:
            return 1 if low >= 0 else -1
        if depth == 0:
            return 0
        middle = (a + b) / 2
        first = self.has_one_slope(a, middle, depth - 1)
        return first if first and first == self.has_one_slope(middle, b, depth - 1) else 0

    def check_step(self, step, kind, start, to, error):
        """Checks the values of a step of a march, and proves the step."""
        for name, t in (("value", start), ("value_at_to", to)):
            if name in step:
                self.check_value(step[name], t, error)
        for place in ("before", "behind"):
            if place in step:
                self.check_value(step["value_" + place], step[place].parameter(), error)
        if kind == "deflation":
            if not self.has_one_slope(start, to):
                raise Wrong(step["to"].at("must end a segment over which the field rises, or falls, all the way"))
            return
        if kind == "sign change":
            least = step["min"].parameter()
            self.check_value(step["value_at_min"], least, error)
            before = self.sign(least)
            if self.sign(to) == 0 or (before and before == self.sign(to)) or (not before and least > 0):
                raise Wrong(step["to"].at("must be behind a crossing, and is not on the other side of the surface"))
            if not self.has_one_slope(least, to):
                raise Wrong(step["to"].at("must end a segment over which the field has one slope"))
            to = least
        if to > start and not self.is_free(start, to):
            raise Wrong(step["to"].at("must end a segment where the field is nowhere 0, which it does not"))

    def check_touch(self, step, t):
        """Checks that the field may vanish next to t: a march ends there whose segments are as short as the last digits of
        t, or of points in double-double."""
        near = (abs(t) + max(sizes(self.line.origin)) / length(self.line.direction)) / 2**50
        low, high = self.over(t - near, t + near)[0]
        if low > 0 or high < 0:
            raise Wrong(step["from"].at("must be next to a place where the field is 0"))

    def check_value(self, value, t, error):
        """Checks the magnitude of a value of the file at t, which may be turned around: a number with an error, or an
        enclosure, whose ends are rounded."""
        low, high = (fraction(k) for k in size_of(self.value(t)))
        if isinstance(value.data, list):
            if not len(value):
                return
            ends = value.vector(2)
            first, last = sorted(abs(x) for x in ends)
            first = 0 if ends[0] <= 0 <= ends[1] else first
            if high < first * (1 - 2 * U) or low > last * (1 + 2 * U):
                value[0].refuse(value[0].number(), low)
        elif abs(value.number()) > high + error or abs(value.number()) < low - error:
            value.refuse(value.number(), low)
