"""Reconstruction filters: places of samples are drawn by the size of a filter, and weighted by its sign."""
from fractions import Fraction

from .functions import exponential, PI, sine_and_cosine
from .values import shown, Wrong

CLOSE = Fraction(1, 2**40)  # more than the roundings of the areas of 256 pieces, of the whole area


def bell(x):
    return exponential(-(x / Fraction(1, 2))**2 / 2)


def mitchell(x):
    z = abs(x)  # 2 |x| over the radius, which is 2
    if z < 1:
        return ((7 * z - 12) * z * z + Fraction(16, 3)) / 6
    return (8 - 7 * z) * (2 - z)**2 / 18


def blackman_harris(x):
    cosines = (sine_and_cosine(k * PI * x / Fraction(3, 2))[1] for k in range(4))
    shares = (Fraction(s) for s in ("0.35875", "0.48829", "0.14128", "0.01168"))
    return sum(share * cosine for share, cosine in zip(shares, cosines))


# Names, with ends of parts between which the curve has one sign, the number of pieces of each part, and the curve.
CURVES = {
    "tent": ((-1, 0, 1), (1, 1), lambda x: 1 - abs(x)),
    "gaussian": ((Fraction(-3, 2), Fraction(3, 2)), (256,), lambda x: bell(x) - bell(Fraction(3, 2))),
    "mitchell": ((-2, Fraction(-8, 7), Fraction(8, 7), 2), (48, 160, 48), mitchell),
    "blackman-harris": ((Fraction(-3, 2), Fraction(3, 2)), (256,), blackman_harris),
}


class Filter:
    """A polygon through points of a curve."""

    def __init__(self, name):
        ends, counts, curve = CURVES[name]
        self.pieces, self.area, signed = [], Fraction(0), Fraction(0)
        for start, end, count in zip(ends, ends[1:], counts):
            width = Fraction(end - start) / count
            for k in range(count):
                left = start + width * k
                turn = -1 if curve(left + width / 2) < 0 else 1
                a, b = (max(Fraction(0), turn * curve(x)) for x in (left, left + width))
                self.pieces.append((left, width, a, b, self.area, turn))
                self.area += (a + b) / 2 * width
                signed += turn * (a + b) / 2 * width
        self.weight = self.area / signed

    def share_up_to(self, place):
        """Returns the share of the area up to a place, and the signs of the filter there: two next to a change."""
        x, share, turns = place - Fraction(1, 2), Fraction(0), set()
        for left, width, a, b, before, turn in self.pieces:
            if left - CLOSE <= x <= left + width + CLOSE:
                y = min(max(x - left, Fraction(0)), width)
                share = (before + a * y + (b - a) * y * y / (2 * width)) / self.area
                turns.add(turn)
        return share, turns

    def turn_of(self, number):
        """Returns the sign of the filter where a share of the area is reached."""
        return [piece for piece in self.pieces if piece[4] <= number * self.area][-1][5]

    def check(self, sample, numbers, all_numbers):
        """Checks the place and the weight of a sample with these numbers. If all pixels have the same places, all_numbers
        are those of the samples, of which the mean weight is 1."""
        right = self.weight**2
        for value, number in zip(sample["position"], numbers):
            share, turns = self.share_up_to(value.number())
            if not turns or abs(share - number) > CLOSE:
                raise Wrong(value.at(f"is {shown(value.number())}, up to which the filter has {shown(share)} of its "
                                     f"area, and not the sampler's {shown(number)}"))
            if len(turns) == 2:
                return  # on the edge between two signs
            right *= turns.pop()
        if all_numbers and self.weight != 1:
            turns = [self.turn_of(x) * self.turn_of(y) for x, y in all_numbers]
            right *= len(turns) / (self.weight**2 * sum(turns))
        sample["weight"].must_be_near(right, CLOSE * abs(right))
