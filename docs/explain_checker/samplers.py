"""The numbers of the samplers: words are whole numbers modulo 2^32 or 2^64."""
import math
from fractions import Fraction

from .exact import f64
from .light import position_in_pixel

GOLDEN = 0x9e3779b97f4a7c15
FACTORS = (0x9e3779b1, 0x85ebca77, 0xc2b2ae3d, 0x27d4eb2f, 0x165667b1, 0xd3a2646d, 0xb55a4f09, 0xfd7046c5, 0xa0761d65)
SET_OF_TIME = 2**32 - 1


def mixed(z):
    """Returns a word of 64 digits, mixed."""
    z = z % 2**64
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9 % 2**64
    z = (z ^ z >> 27) * 0x94d049bb133111eb % 2**64
    return z ^ z >> 31


def pixel_key(seed, x, y):
    return mixed(mixed(x << 32 | y) + mixed(seed + GOLDEN))


def set_key(key, set_number, part):
    return mixed(key + (set_number << 32 | part) * GOLDEN)


def unit_of_word(word):
    return Fraction(2 * word + 1, 2**33)


def reversed_digits(word):
    return int(f"{word:032b}"[::-1], 2)


def seed_of(key, i):
    """Returns word i of the lower half of a set's key."""
    x = key % 2**32 * FACTORS[i] % 2**32
    return x ^ x >> 15


def word_of(key, i):
    """Returns word i of both halves of a set's key."""
    return (seed_of(key, i) + (key >> 32)) % 2**32


def nested(x, seed):
    """Returns a nested uniform scrambling (Owen 1995) of digits, read from the lowest."""
    x = (x + seed) % 2**32
    x = x * (seed >> 9 | 1) % 2**32
    x ^= x * 0x2cd3cde2 % 2**32
    x = (x + (seed >> 17)) % 2**32
    return x ^ x * (seed >> 25 & 0xfffffffe) % 2**32


def shuffled_index(index, seed):
    """Returns an index of which the first 2^k stay the first 2^k, for each k."""
    return reversed_digits(nested(reversed_digits(index), seed) ^ nested(0, seed))


def independent_words(key, set_number, part):
    first = set_key(key, set_number, part)
    second = mixed(first + GOLDEN)
    return [first % 2**32, first >> 32, second % 2**32, second >> 32]


def independent_numbers(seed, pixel, set_number, sample, count):
    return [unit_of_word(word) for word in independent_words(pixel_key(seed, *pixel), set_number, sample)]


def direction_numbers(ms, coefficients):
    """Returns the 32 direction numbers of one of Sobol's coordinates: the first are m_k 2^-(k + 1), and each further
    one follows from those before it by a recurrence with the coefficients of a primitive polynomial."""
    v = [m << (31 - k) for k, m in enumerate(ms)]
    while len(v) < 32:
        following = v[-len(ms)] >> len(ms)
        for i, coefficient in enumerate(coefficients):
            following ^= coefficient * v[-1 - i]
        v.append(following)
    return v


# Of the polynomials x + 1, x² + x + 1 and x³ + x + 1 (Joe and Kuo 2008), after van der Corput's coordinate.
SOBOL = [[1 << (31 - k) for k in range(32)], direction_numbers([1], [1]), direction_numbers([1, 3], [1, 1]),
         direction_numbers([1, 3, 1], [0, 1, 1])]


def sobol_numbers(seed, pixel, set_number, sample, count):
    """Returns the numbers of Sobol's points. Even and odd samples belong to two scramblings."""
    key = set_key(pixel_key(seed, *pixel), set_number, sample % 2)
    index, numbers = shuffled_index(sample // 2, seed_of(key, 0)), []
    for d, directions in enumerate(SOBOL):
        digits = 0
        for k, direction in enumerate(directions):
            digits ^= direction * (index >> k & 1)
        scrambled = nested(reversed_digits(digits), seed_of(key, 1 + d))
        numbers.append(unit_of_word(reversed_digits(scrambled) ^ word_of(key, 5 + d)))
    return numbers


def hammersley_numbers(seed, pixel, set_number, sample, count):
    """Returns Hammersley's points for set 0, and otherwise Sobol's for the pixel (0, 0)."""
    numbers = sobol_numbers(seed, (0, 0), set_number, sample, count)
    return [f64(x) for x in position_in_pixel(sample, count)] + numbers[2:] if set_number == 0 else numbers


def halton_word(base, index, key):
    """Returns a coordinate of Halton's points: the digits of the index, scrambled digit by digit and read backwards."""
    results, power = 0, 1
    node = mixed(key + base * GOLDEN)
    rest = node >> 32
    while index and power <= 2**32 // base:
        index, digit = divmod(index, base)
        result, rest = divmod(rest * base, 2**32)
        if digit:
            code = mixed(node + power)
            result = (result + (1 + ((code >> 32) * (base - 1) >> 32)) * digit) % base
            node = (code + digit * GOLDEN) % 2**64
            rest = mixed(node) >> 32
        results, power = results * base + result, power * base
    return (results * 2**32 + rest) // power


def halton_numbers(seed, pixel, set_number, sample, count):
    key = set_key(pixel_key(seed, *pixel), set_number, sample % 2)
    index = shuffled_index(sample // 2, seed_of(key, 0))
    # The digits in base 2, read backwards, are the index itself with its lowest digit as the first one.
    of_base_2 = reversed_digits(nested(index, seed_of(key, 1))) ^ word_of(key, 2)
    return [unit_of_word(of_base_2)] + [unit_of_word(halton_word(base, index, key)) for base in (3, 5, 7)]


def grid_of(n):
    """Returns the columns and rows of the cells for n samples."""
    root_of_n = math.isqrt(n)
    for columns in range(root_of_n, 0, -1):
        if 2 * columns**2 < n:
            break
        if n % columns == 0:
            return columns, n // columns
    return root_of_n, -(-n // root_of_n)


def shuffled_place(i, count, first, second):
    """Returns place i of so many in a random order, which two words give."""
    digits = max(1, (count - 1).bit_length())
    down, mask = (digits + 1) // 2, 2**digits - 1
    while True:
        i = (i + first) * (second | 1) & mask
        i ^= i >> down
        i = (i + (second >> 8)) * (first >> 8 | 1) & mask
        i ^= i >> down
        i = (i + (first >> 16)) * (second >> 16 | 1) & mask
        i ^= i >> down
        if i < count:
            break
    offset = (first ^ second * FACTORS[0] % 2**32) * count >> 32
    return (i + offset) % count


def stratified_numbers(seed, pixel, set_number, sample, count):
    """Returns a random place in a cell of a grid, for each pair of numbers."""
    key, (columns, rows) = pixel_key(seed, *pixel), grid_of(count)
    places = [unit_of_word(word) for word in independent_words(key, set_number, sample)]
    orders = independent_words(key, set_number, 2**32 - 1 - sample // count)
    numbers = []
    for pair in (0, 2):
        row, column = divmod(shuffled_place(sample % count, columns * rows, *orders[pair:pair + 2]), columns)
        numbers += [f64((column + places[pair]) / columns), f64((row + places[pair + 1]) / rows)]
    return numbers


SAMPLERS = {"hammersley": hammersley_numbers, "sobol": sobol_numbers, "halton": halton_numbers,
            "stratified": stratified_numbers, "independent": independent_numbers}
