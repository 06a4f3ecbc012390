"""Reads PNG files with 8 bits for each of red, green and blue, as those of tests/golden are, with the standard library."""
import struct
import zlib


def read(path):
    """Returns width, height, and the bytes of all pixels, row by row. Raises ValueError for PNG files of other kinds."""
    data = path.read_bytes()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError(f"{path} is no PNG file")
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, *rest = struct.unpack(">IIBBBBB", body)
            if rest != [8, 2, 0, 0, 0]:
                raise ValueError(f"{path}: its pixels are not red, green and blue with 8 bits each")
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    rows, stride = zlib.decompress(packed), 3 * width
    result, above = bytearray(), bytes(stride)
    for y in range(height):  # each row is the difference from a prediction by bytes to the left and above
        kind, row = rows[y * (stride + 1)], bytearray(rows[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left, up, corner = (row[x - 3], above[x], above[x - 3]) if x >= 3 else (0, above[x], 0)
            if kind == 1:
                row[x] = (row[x] + left) & 255
            elif kind == 2:
                row[x] = (row[x] + up) & 255
            elif kind == 3:
                row[x] = (row[x] + (left + up) // 2) & 255
            elif kind == 4:
                to_left, to_up, to_corner = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
                nearest = left if to_left <= to_up and to_left <= to_corner else up if to_up <= to_corner else corner
                row[x] = (row[x] + nearest) & 255
        result += row
        above = row
    return width, height, bytes(result)
