"""Hits: point, normal, texture coordinates and color."""
import math
from fractions import Fraction

from .exact import add, cross, dot, f32, length, minus, sign, sizes, times, unit
from .light import angles_of, check_along
from .mesh import Mesh
from .surfaces import is_given
from .values import U


class Hits:
    """Checks of hits."""

    def check_hit(self, hit, line, one, i=0):
        """Checks point, normal and color of the hit at crossing i of a surface that is considered; returns the hit."""
        surface = self.surfaces[one["surface"].whole()]
        if hit["t"].number() != one["t"][i].number():
            hit["t"].refuse(hit["t"].number(), one["t"][i].number())
        part = one["parts"][i].whole()
        hit["part"].must_be(part)
        if "primitive" in hit and isinstance(surface, Mesh):
            surface.check_primitive(hit["primitive"], part)
        t = hit["t"].number()
        right = add(line.origin, times(t, line.direction))
        hit["point"].must_be_near_vector(
            right, times(2 * U, add(sizes(line.origin), times(t, sizes(line.direction)))))
        point = hit["point"].vector()
        if is_given(surface) and not getattr(surface, "field", None):
            self.given.add("the normal on a surface whose triangles, or whose type, the file does not tell")
        else:
            hit["normal"].must_be_near_vector(surface.normal(point, part), surface.normal_error(point, part))
        normal = hit["normal"].vector()
        towards_eye = dot(normal, line.direction)
        error = 8 * U * dot(sizes(normal), sizes(line.direction))
        turned = times(-1, normal)
        if towards_eye > error or (abs(towards_eye) <= error and hit["facing_normal"].vector() != normal):
            hit["facing_normal"].must_equal(turned)
        else:
            hit["facing_normal"].must_equal(normal)
        if "uv" in hit:
            self.check_uv(hit, surface, point, part)
        if "normal_map" in hit:
            self.check_normal_map(hit, surface, point, part)
        # A surface has one material. Each hit tells which pixel of its image is there.
        hit["material"].must_agree(self.materials.setdefault(surface, hit["material"]), ("column", "row"))
        self.check_color(hit)
        return hit

    def check_uv(self, hit, surface, point, part):
        if is_given(surface):
            self.given.add("u and v on a surface whose triangles, or whose type, the file does not tell")
            return
        right, errors = surface.uv(point, part), surface.uv_errors(point, part, 0)
        for i in angles_of(surface, part):
            right[i] += round(hit["uv"][i].number() - right[i])
        hit["uv"].must_be_near_vector(right, errors)

    def check_normal_map(self, hit, surface, point, part):
        """Checks the tangents, and the shading normal that follows from them, the normal and the map's direction."""
        mapped, normal = hit["normal_map"], hit["normal"].vector()
        self.check_direction(hit, mapped)
        if is_given(surface):
            self.given.add("the tangents of a surface whose triangles, or whose type, the file does not tell")
        else:
            tangents, error = surface.tangents(point, part, 0)
            for name, right in zip(("tangent_u", "tangent_v"), tangents):
                if error < Fraction(1, 2) and any(right):
                    check_along(mapped[name], right, error)
        found, right = mapped["shading_normal"], normal
        (x, y, z), u, v = (mapped[name].vector() for name in ("direction", "tangent_u", "tangent_v"))
        across = cross(normal, u)
        side = dot(across, v)
        if (x or y) and side:
            t, b = unit(cross(across, normal)), unit(across)
            tilted = lambda sign_of_b: unit(add(add(times(x, t), times(sign_of_b * y, b)), times(z, normal)))
            right = tilted(sign(side))
            # Where the tangents are nearly parallel, the sign is that of the rounded product, or the product is 0.
            if abs(side) <= 8 * U * sum(sizes(u)) * sum(sizes(v)):
                right = min((tilted(1), tilted(-1), normal), key=lambda n: length(minus(n, found.vector())))
        # Each part of the frame is off by a few U over the sine of the angle between u and the normal.
        found.must_be_near_vector(right, 64 * U * (1 + length(u) / (length(across) or 1)))
        turn = 1 if hit["facing_normal"].vector() == normal else -1
        mapped["facing_shading_normal"].must_equal(times(turn, found.vector()))

    def check_direction(self, hit, mapped):
        """Checks the direction that a normal map holds at u and v: twice the numbers of a pixel, less 1."""
        if "image" not in mapped:
            self.given.add("the directions that normal maps of a function hold at u and v")
            return
        codes, reason = self.images.codes_at(mapped["image"], hit["uv"].vector(2))
        if reason:
            self.given.add(f"the directions of {reason}")
        else:
            mapped["direction"].must_equal([2 * f32(Fraction(code, 255)) - 1 for code in codes])

    def check_color(self, hit):
        material = hit["material"]
        if "image" in material:
            right, error, reason = self.images.texture_at(material["image"], hit["uv"].vector(2))
            if reason:
                self.given.add(f"the colors of {reason}")
            else:
                hit["color"].must_be_near_vector(right, [x * error for x in right])
            return
        if "diffuse" in material:
            color = material["diffuse"].vector()
        elif "checker" not in material:
            self.given.add("colors of textures that are functions")
            return
        else:
            checker = material["checker"]
            u, v = (float(x) for x in hit["uv"].vector(2))
            square = float(checker["size"].number())
            parity = (math.floor(u / square) + math.floor(v / square)) % 2
            color = checker["second" if parity else "first"].vector()
        hit["color"].must_equal(color)
