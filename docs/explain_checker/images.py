"""Images of textures, normal maps and environments: PNG files of 8 bits, by zlib, and Radiance HDR files."""
import json
import math
import zlib
from fractions import Fraction

from .functions import power
from .values import Unreadable, Wrong

CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}  # of a pixel, by the color type


class NotRead(Exception):
    """The file is none that can be read here."""


class Png:
    """The codes of a PNG file (ISO 15948)."""

    def __init__(self, name, data):
        at, compressed, self.palette = 8, b"", b""
        while at + 8 <= len(data):
            size, kind = int.from_bytes(data[at:at + 4], "big"), data[at + 4:at + 8]
            content, at = data[at + 8:at + 8 + size], at + 12 + size
            if kind == b"IHDR":
                self.width, self.height = (int.from_bytes(content[i:i + 4], "big") for i in (0, 4))
                depth, self.type, _, _, is_interlaced = content[8:13]
            elif kind == b"PLTE":
                self.palette = content
            elif kind == b"IDAT":
                compressed += content
        if depth != 8 or is_interlaced:
            raise NotRead(f"the image {name}, which has no codes of 8 bits row by row")
        self.channels = CHANNELS[self.type]
        self.data, self.rows = zlib.decompress(compressed), []
        if len(self.data) < self.height * (self.width * self.channels + 1):
            raise NotRead(f"the image {name}, which is not complete")

    def row(self, y):
        """Returns a row of codes, after those above: each code is the difference from a prediction by its neighbors."""
        n, width = self.channels, self.width * self.channels
        while len(self.rows) <= y:
            start = len(self.rows) * (width + 1)
            above = self.rows[-1] if self.rows else bytearray(width)
            kind, row = self.data[start], bytearray(self.data[start + 1:start + 1 + width])
            for i in range(width if kind else 0):
                left = row[i - n] if i >= n else 0
                upper, corner = above[i], above[i - n] if i >= n else 0
                if kind == 4:  # the neighbor nearest to left + upper - corner, in this order
                    predicted = min((abs(upper - corner), 0, left), (abs(left - corner), 1, upper),
                                    (abs(left + upper - 2 * corner), 2, corner))[2]
                else:
                    predicted = (0, left, upper, (left + upper) // 2)[kind]
                row[i] = (row[i] + predicted) % 256
            self.rows.append(row)
        return self.rows[y]

    def codes(self, column, row):
        """Returns red, green and blue of a pixel."""
        start = column * self.channels
        pixel = self.row(row)[start:start + self.channels]
        if self.type == 3:
            return list(self.palette[3 * pixel[0]:3 * pixel[0] + 3])
        return list(pixel[:3]) if self.channels >= 3 else [pixel[0]] * 3


class Hdr:
    """The light of a Radiance HDR file: three mantissas and an exponent for each pixel, row by row, in runs or flat."""

    def __init__(self, name, data):
        self.data, (head, found, rest) = data, data.partition(b"\n\n")
        size = rest[:rest.index(b"\n")].split()
        if len(size) != 4 or size[0] != b"-Y" or size[2] != b"+X":
            raise NotRead(f"the image {name}, whose rows are not from left to right and from above")
        self.height, self.width = int(size[1]), int(size[3])
        self.at, self.rows = len(head) + len(found) + rest.index(b"\n") + 1, []

    def row(self, y):
        """Returns the four channels of a row, after those above."""
        while len(self.rows) <= y:
            if self.data[self.at:self.at + 2] == b"\2\2" and 8 <= self.width < 2**15:
                self.at += 4
                channels = [self.channel() for _ in range(4)]
            else:
                flat = self.data[self.at:self.at + 4 * self.width]
                self.at += 4 * self.width
                channels = [flat[i::4] for i in range(4)]
            self.rows.append(channels)
        return self.rows[y]

    def channel(self):
        """Returns one channel of a row: a count and as many bytes, or 128 plus a count and the byte that is repeated."""
        channel = bytearray()
        while len(channel) < self.width:
            count = self.data[self.at]
            if count > 128:
                channel += self.data[self.at + 1:self.at + 2] * (count - 128)
                self.at += 2
            else:
                channel += self.data[self.at + 1:self.at + 1 + count]
                self.at += 1 + count
        return channel

    def light(self, column, row):
        """Returns red, green and blue of a pixel, which float holds exactly."""
        *mantissas, exponent = (channel[column] for channel in self.row(row))
        return [Fraction(m) * Fraction(2)**(exponent - 136) if exponent else Fraction(0) for m in mantissas]


def image_of(path, name):
    """Returns the image in a file, by its first bytes; the name is for messages."""
    try:
        with open(path, "rb") as file:
            data = file.read()
    except OSError as error:
        raise NotRead(f"the image {name}, which cannot be read") from error
    if data.startswith(b"\x89PNG\r\n\x1a\n"):
        return Png(name, data)
    if data.startswith((b"#?RADIANCE\n", b"#?RGBE\n")):
        return Hdr(name, data)
    raise NotRead(f"the image {name}, which is no PNG and no Radiance HDR")


def light_of_code(code):
    """Returns the light of a code of sRGB."""
    x = Fraction(code, 255)
    if x <= Fraction("0.04045"):
        return x / Fraction("12.92")
    return power((x + Fraction("0.055")) / Fraction("1.055"), Fraction("2.4"))


class Images:
    """The images that an explanation names, each read once."""

    def __init__(self):
        self.read = {}

    def codes_at(self, image, uv):
        """Returns the codes of the pixel of an image at u and v, and the reason if there are none."""
        place, size = self.place_at(image, uv)
        found, reason = self.file(image["file"], size, image["pixels"])
        if reason or not isinstance(found, Png):
            return None, reason or f"the image {image['file'].word()}, which holds no codes"
        return found.codes(*place), None

    def texture_at(self, image, uv):
        """Returns the light of the pixel of an image at u and v, its relative error, and the reason if there is none."""
        place, size = self.place_at(image, uv)
        return self.light_at(image["file"], size, image["pixels"], *place)

    def place_at(self, image, uv):
        """Checks which pixel of an image is at u and v; returns it, and the size of the image."""
        size = image["pixels"].vector(2)
        place = []
        for x, pixels, extent, name in zip(uv, size, image["size"].vector(2), ("column", "row")):
            of_one = float(x) / float(extent)  # as doubles, of which the next pixel may begin at the rounded number
            at = (of_one - math.floor(of_one)) * int(pixels)
            place.append(min(int(at), int(pixels) - 1) if at > 0 else 0)
            image[name].must_be(place[-1])
        return place, size

    def file(self, name, size, where):
        """Returns an image, and the reason if the file is none that can be read here."""
        try:
            path = json.loads(f'"{name.word()}"')
        except ValueError as error:
            raise Unreadable(name.at("is not a word of JSON")) from error
        if not path:
            return None, "an image that is in no file"
        if path not in self.read:
            try:
                self.read[path] = image_of(path, name.word())
            except (NotRead, zlib.error, ValueError, KeyError, IndexError) as error:
                self.read[path] = error if isinstance(error, NotRead) else NotRead(f"the image {name.word()}, which is damaged")
        found = self.read[path]
        if isinstance(found, NotRead):
            return None, str(found)
        if [found.width, found.height] != size:
            raise Wrong(where.at(f"is not the size of {name.word()}, {found.width} by {found.height}"))
        return found, None

    def light_at(self, name, size, where, column, row):
        """Returns the light of a pixel of an image and its relative error, and the reason if there is none."""
        found, reason = self.file(name, size, where)
        if reason:
            return None, 0, reason
        try:
            if isinstance(found, Hdr):
                return found.light(column, row), 0, None
            return [light_of_code(code) for code in found.codes(column, row)], Fraction(1, 2**23), None
        except IndexError:
            return None, 0, f"the image {name.word()}, which is damaged"
