"""Images of textures and normal maps: PNG files of 8 bits, by zlib."""
import math
import zlib
from fractions import Fraction

from .functions import power
from .values import Wrong

CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}  # of a pixel, by the color type


class NotRead(Exception):
    """The file is none that can be read here."""


class Png:
    """The codes of a PNG file (ISO 15948)."""

    def __init__(self, path):
        try:
            with open(path, "rb") as file:
                data = file.read()
        except OSError as error:
            raise NotRead(f"the image {path}, which cannot be read") from error
        if not data.startswith(b"\x89PNG\r\n\x1a\n"):
            raise NotRead(f"the image {path}, which is no PNG")
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
            raise NotRead(f"the image {path}, which has no codes of 8 bits row by row")
        self.channels = CHANNELS[self.type]
        self.data, self.rows = zlib.decompress(compressed), []
        if len(self.data) < self.height * (self.width * self.channels + 1):
            raise NotRead(f"the image {path}, which is not complete")

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
        """Checks which pixel of an image is at u and v, and returns its codes; the reason if the file is none that can
        be read here."""
        size = image["pixels"].vector(2)
        place = []
        for x, pixels, extent, name in zip(uv, size, image["size"].vector(2), ("column", "row")):
            of_one = float(x) / float(extent)  # as doubles, of which the next pixel may begin at the rounded number
            at = (of_one - math.floor(of_one)) * int(pixels)
            place.append(min(int(at), int(pixels) - 1) if at > 0 else 0)
            image[name].must_be(place[-1])
        path = image["file"].word().replace("\\\\", "\\").replace('\\"', '"')
        if not path:
            return None, "an image that is in no file"
        if path not in self.read:
            try:
                self.read[path] = Png(path)
            except (NotRead, zlib.error, ValueError, KeyError, IndexError) as error:
                self.read[path] = error if isinstance(error, NotRead) else NotRead(f"the image {path}, which is damaged")
        found = self.read[path]
        if isinstance(found, NotRead):
            return None, str(found)
        if [found.width, found.height] != size:
            raise Wrong(image["pixels"].at(f"is not the size of {path}, {found.width} by {found.height}"))
        return found.codes(*place), None
