"""Fields that are marched: the steps of a march and the numbers that prove them."""
from fractions import Fraction

from .exact import length, sign, sizes, unit
from .field import Field, FieldAlong, fraction
from .surfaces import Departure, surface_type
from .values import shown, TINY, U, Unreadable, Wrong


@surface_type("marched")
class Marched:
    """A field that is marched. The steps of the march say where to look; each is proven again, by the field itself if it
    is in the file. Otherwise its values are the file's, and what follows from them about the ray is checked."""

    is_given = True

    def __init__(self, facts):
        self.ends = facts["min"].vector(), facts["max"].vector()
        self.lipschitz, self.error = facts["lipschitz"].number(), facts["error"].number()
        self.bends = [sign * facts[name].number() for name, sign in (("least_curvature", -1), ("most_curvature", 1))
                      if name in facts]  # of the field, and of the field turned around
        self.field = Field(facts["parts"]) if "parts" in facts else None

    def normal(self, point, part):
        """Returns the direction of the gradient."""
        return unit([fraction(low + high) for low, high in self.gradient(point)])

    def normal_error(self, point, part):
        """Returns the error of the normal: that of a gradient which is known for points as near as roundings of the
        library move them. Where it jumps, at an edge, any normal between those of both sides is right; where it is 0 all
        around, one is."""
        gradient = self.gradient(point)
        middle = length([fraction(low + high) / 2 for low, high in gradient])
        width = length([fraction(high - low) for low, high in gradient])
        if width > middle / 4:
            return Fraction(2)
        return (2 * width / middle if width else 0) + Fraction(1, 2**40)

    def gradient(self, point):
        return self.field.gradient(point, (1 + max(sizes(point))) / 2**46)

    def departure(self, part):
        return Departure("object", None, self, part)

    def span(self, line):
        """Returns the ends of the part of the line inside the box of the field, not in order if it goes beside the box; or
        None for one that goes along a face outside."""
        low, high = None, None
        for a, b, o, d in zip(*self.ends, line.origin, line.direction):
            if d == 0:
                if not a <= o <= b:
                    return None
                continue
            first, second = sorted(((a - o) / d, (b - o) / d))
            low = first if low is None else max(low, first)
            high = second if high is None else min(high, second)
        return low, high

    def check_march(self, steps, line, end):
        """Checks the steps of a march: that they cover the ray in the box without a gap, up to a crossing in the range
        or to the end of both, and each by the numbers that prove it. Returns the enclosures of the last crossing in
        the range."""
        low, high = self.span(line) or (None, None)
        leaves = line.left is not None and line.left.owner is self
        # Ends of the box are rounded: from far away, the march may be of a part of the line that is empty.
        near = max(abs(low), abs(high), *sizes(line.origin)) / 2**40 if low is not None else 0
        is_empty = low is None or low >= high or high <= 0
        if is_empty and not len(steps):
            return []
        if low is None or low - near >= high + near or high + near <= 0:
            raise Wrong(steps.at(f"has {len(steps)} steps, and the ray misses the box of the field"))
        d, slack = length(line.direction), 1 + Fraction(1, 2**30)
        # The bound of the error of a value on this line (docs/numerics.md); twice that for the difference of two.
        error = self.lipschitz * U * (2 * length(line.origin) + 6 * max(abs(low), abs(high)) * d) + self.error
        error, reach = error * slack * (2 if leaves else 1), 1 / (self.lipschitz * d)
        at, found = Fraction(0) if leaves else max(low, Fraction(0)), []
        along = FieldAlong(self.field, line, leaves) if self.field else None
        known = None  # lower bound of the field at `at`, from the last step
        for i, step in enumerate(steps):
            if found:
                raise Wrong(step.at("follows a step that has found the first crossing"))
            kind, begin, to = step["type"].word(), step["from"], step["to"].parameter()
            start = begin.parameter()
            # A march that goes back from double-double to double begins with the double below t.
            if abs(start - at) > (near if i == 0 else 2 * U * abs(at)) + TINY or (i > 0 and start > at):
                begin.refuse(start, at)
            if kind == "touch":
                if along:
                    along.check_touch(step, start)
                found.append((start, start))
                continue
            if to <= start:
                step["to"].refuse(to, start)
            if to > high + near and kind != "deflation":  # which need not end in the box
                step["to"].refuse(to, high)
            at, width = to, to - start
            last, known = known, None
            if along:
                along.check_step(step, kind, start, to, error)
            if kind in ("ball", "two balls"):
                radius = (step["value"].number() - error) * reach
                if kind == "two balls":
                    radius += (step["value_at_to"].number() - error) * reach
                # A ball leads to its border, or to the end of the box.
                error_of_radius = radius / 2**25 + 8 * U * abs(to)
                if width > radius + error_of_radius or \
                        (kind == "ball" and width < radius - error_of_radius - error * reach and abs(to - high) > near):
                    step["to"].refuse(to, start + radius)
            elif kind == "bend":
                self.check_bend(step, start, width, error, reach, d)
            elif kind in ("segment", "precise segment"):
                known = self.check_segment(step, width, last, error, kind == "segment")
            elif kind == "deflation":
                if i or not leaves:
                    raise Wrong(step.at("must be the first step of a ray that leaves this surface"))
                a, b = step["slopes"].vector(2)
                if a < 0 < b:
                    raise Wrong(step["slopes"].at("must be of one sign"))
                # A slope of double-double is rounded in the file, by 2^-53 of itself. What the library takes is less by
                # 2^-50, and as much as that may count in the segments that follow.
                known = (a if a >= 0 else -b) * width * (1 - Fraction(1, 2**52))
            elif kind == "sign change":
                least, most = step["min"].parameter(), to
                if not start <= least <= most:
                    step["min"].refuse(least, start)
                if "behind" in step:
                    self.check_fall(step, start, most, error, d)
                elif step["slopes"].vector(2)[1] > 0:
                    step["slopes"][1].refuse(step["slopes"][1].number(), Fraction(0))
                self.check_sign(step["value_at_to"], error, -1)
                if least > start:
                    self.check_sign(step["value_at_min"], error, 1)
                if most > 0 and (end is None or least < end):
                    found.append((least, most))
            else:
                raise Wrong(step["type"].at("must be ball, two balls, bend, segment, precise segment, deflation, sign "
                                            "change or touch"))
        if not found and not (at >= high - near or (end is not None and at >= end)):
            raise Wrong(steps.at(f"must reach the end of the box, at t = {shown(high)}, and ends at {shown(at)}"))
        return found

    def check_bend(self, step, start, width, error, reach, d):
        """Checks that the line through two values, less what the bend takes from it, is above 0 up to the end of a step, or
        to the ball there. Convexity: F(t + s) ≥ F(t) + q s − ½ b s (s + w), with the slope q over w before t."""
        before = start - step["before"].parameter()
        if before <= 0:
            step["before"].refuse(start - before, start)
        value = step["value"].number() - error
        q = (value - step["value_before"].number() - error) / before
        ball = 0
        if isinstance(step["value_at_to"].data, Fraction):  # it is empty at the end of the box
            ball = max(Fraction(0), (step["value_at_to"].number() - error) * reach)
        s = max(Fraction(0), width - ball) * (1 - Fraction(1, 2**25))
        if not any(value + q * s - max(Fraction(0), b) * d * d * s * (s + before) / 2 >= 0 for b in self.bends):
            step["to"].refuse(start + width, start)

    def check_fall(self, step, start, to, error, d):
        """Checks that the slope behind a crossing is so far below 0 that the field falls from the start on."""
        behind = step["behind"].parameter()
        if behind <= to:
            step["behind"].refuse(behind, to)
        rise = (step["value_behind"].number() - step["value_at_to"].number() + 2 * error) / (behind - to)
        if not any(rise + max(Fraction(0), b) * d * d * (behind - start) <= 0 for b in self.bends):
            step["value_behind"].refuse(step["value_behind"].number(), Fraction(0))

    def check_sign(self, value, error, right):
        """Checks that a value has a sign for certain: in double beyond its error, or enclosed on one side of 0."""
        if isinstance(value.data, list):
            nearest_to_0 = value.vector(2)[0 if right > 0 else 1]
        else:
            nearest_to_0 = value.number() - right * error * (1 - Fraction(1, 2**20))
        if sign(nearest_to_0) != right:
            raise Wrong(value.at(f"must be {'above' if right > 0 else 'below'} 0 for certain"))

    def check_segment(self, step, width, known, error, is_double):
        """Checks that the field is above 0 all over a segment, and returns a lower bound at its end. Numbers of
        double-double are rounded in the file: there the signs are checked alone."""
        least, (lo, hi) = step["values"][0], step["slopes"].vector(2)

        def least_of(value):
            if isinstance(value.data, list):
                return value.vector(2)[0] if len(value) else None
            return value.number() - error * (1 - Fraction(1, 2**20))

        left, right = least_of(step["value"]), least_of(step["value_at_to"])
        left = known if left is None else left if known is None else max(left, known)
        if left is None or right is None:
            raise Unreadable(step.at("must have values at both ends"))
        bounds = [left + min(lo, 0) * width, right - max(hi, 0) * width]
        if least.data != "-infinity":  # from far away points in double tell no values, and slopes alone prove a segment
            bounds.append(least.number())
        if lo < 0 < hi and left > 0 and right > 0:
            bounds.append((hi * left - lo * right + lo * hi * width) / (hi - lo))
        if is_double and max(bounds) <= 0:
            raise Wrong(step["values"].at("and the other numbers of the segment must prove the field to be above 0"))
        return max(right, max(bounds), left + lo * width)
