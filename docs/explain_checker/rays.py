"""Rays, and where they cross surfaces."""
from fractions import Fraction

from .equations import check_equation
from .exact import Root
from .marched import Marched
from .surfaces import is_given, Line
from .values import U, Unreadable, Value, Wrong


class Rays:
    """Checks of rays."""

    def line_of(self, ray):
        left = None
        if not ray["leaves"].is_null():
            left = self.surfaces[ray["leaves"].index(len(self.surfaces))].departure(ray["leaves_part"].whole())
        return Line(ray["origin"].vector(), ray["direction"].vector(), left)

    def check_ray(self, ray):
        """Checks which surfaces a ray crosses and where; returns the crossings in the range of each."""
        if ray["range_end"].data == "infinity":
            end = None
        else:
            end = ray["range_end"].number()
            if self.integrator != "ambient-occlusion":
                ray["range_end"].must_be(1)
            elif end != self.file["distance"].data:  # from which on surfaces occlude nothing
                ray["range_end"].refuse(end, self.file["distance"].number())
        query = ray["query"].word()
        if query not in ("closest", "any", "all"):
            raise Wrong(ray["query"].at("must be closest, any or all"))
        line, all_of = self.line_of(ray), []
        for i, one in enumerate(ray["considered"]):
            one["surface"].must_be(i)
            one["surface"].index(len(self.surfaces))
            if one["decided"].word() not in ("double", "double-double", "exact"):
                raise Wrong(one["decided"].at("must be double, double-double or exact"))
            surface = self.surfaces[i]
            check_equation(one["equation"], surface, line, False)
            found = self.crossings_of(one, surface, line, query, end)
            found = [x for x in found if x.minus(0) > 0 and (end is None or x.minus(end) < 0)]
            found = found if query == "all" else found[:1]
            self.check_crossings(one, found, is_given(surface))
            all_of.append(found)
        is_complete = len(all_of) == len(self.surfaces)
        hits = [i for i, found in enumerate(all_of) if found]
        if query == "all":
            taken = None
        else:
            taken = None
            for i in hits:
                if taken is None or (query == "closest" and all_of[i][0].order(all_of[taken][0]) < 0):
                    taken = i
            ray["taken"].must_be(taken)
        if query == "any" and taken is not None:
            is_complete = len(all_of) == taken + 1
        if not is_complete:
            raise Wrong(ray["considered"].at(f"has {len(all_of)} surfaces of {len(self.surfaces)}"))
        return line, all_of, taken

    def crossings_of(self, one, surface, line, query, end):
        """Returns the crossings of a line with a surface; those of a mesh are the file's."""
        if not is_given(surface):
            return surface.roots(line)
        if isinstance(surface, Marched) and query != "all":
            if not surface.field:
                self.given.add("the values and slopes of a field that is marched, and its Lipschitz constant")
            one["equation"]["type"].must_be("march")
            steps = one["equation"]["parts"] if "parts" in one["equation"] else Value(one.line, one.path)
            if steps.is_null():
                steps.data = []
            found = surface.check_march(steps, line, end)
            for t in one["t"]:
                for low, high in found:
                    t.must_be_near((low + high) / 2, 2 * U * high)
            return [Root(Fraction(1), (low + high) / 2) for low, high in found]
        self.given.add("the crossings of a surface of a type of your own, and all crossings of a field")
        return [Root(Fraction(1), t.number(), part=part.whole()) for t, part in zip(one["t"], one["parts"])]

    def check_crossings(self, one, found, given):
        if len(one["t"]) != len(found):
            raise Wrong(one["t"].at(f"has {len(one['t'])} crossings, and there are {len(found)}"))
        if len(one["parts"]) != len(found) or len(one["intervals"]) != 2 * len(found):
            raise Unreadable(one.at("must have a part and an interval for each t"))
        for i, crossing in enumerate(found):
            t, low, high = one["t"][i], one["intervals"][2 * i], one["intervals"][2 * i + 1]
            low.must_be_near(t.number() * (1 - Fraction(1, 2**30)), 4 * U * abs(t.number()))
            high.must_be_near(t.number() * (1 + Fraction(1, 2**30)), 4 * U * abs(t.number()))
            if crossing.minus(low.number() - crossing.slack) < 0 or crossing.minus(high.number() + crossing.slack) > 0:
                t.refuse(t.number(), crossing.about())
            one["parts"][i].must_be(crossing.part)
