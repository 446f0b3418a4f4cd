"""The largest eigenvalues of a linear map: a Krylov space of it (Arnoldi), then QR steps. Standard library only."""
import cmath
import math
import random
from operator import mul


def dot(a, b):
    return sum(map(mul, a, b))


def hessenberg(apply, size, krylov):
    """Arnoldi, each vector made square to the others twice."""
    chance = random.Random(1)
    vector = [chance.uniform(-1.0, 1.0) for _ in range(size)]
    length = math.sqrt(dot(vector, vector))
    basis, columns = [[value / length for value in vector]], []
    for _ in range(min(krylov, size)):
        vector, column = apply(basis[-1]), [0.0] * len(basis)
        for _ in range(2):
            for at, other in enumerate(basis):
                share = dot(vector, other)
                column[at] += share
                vector = [a - share * b for a, b in zip(vector, other)]
        length = math.sqrt(dot(vector, vector))
        columns.append(column + [length])
        if length < 1e-13 * math.sqrt(dot(column, column)):
            break
        basis.append([value / length for value in vector])
    count = len(columns)
    return [[complex(column[row]) if row < len(column) else 0j for column in columns] for row in range(count)]


def eigenvalues(matrix):
    """Of a Hessenberg matrix, by QR steps with Wilkinson's shift."""
    found, rows = [], [row[:] for row in matrix]
    while len(rows) > 1:
        last = len(rows) - 1
        if abs(rows[last][last - 1]) < 1e-14 * (abs(rows[last][last]) + abs(rows[last - 1][last - 1])):
            found.append(rows[last][last])
            rows = [row[:last] for row in rows[:last]]
            continue
        a, b, c, d = rows[-2][-2], rows[-2][-1], rows[-1][-2], rows[-1][-1]
        root = cmath.sqrt((a - d) ** 2 / 4 + b * c)
        shift = min((a + d) / 2 + root, (a + d) / 2 - root, key=lambda value: abs(value - d))
        rows = qr_step(rows, shift)
    return found + [rows[0][0]]


def qr_step(rows, shift):
    count, turns = len(rows), []
    for at in range(count):
        rows[at][at] -= shift
    for at in range(count - 1):
        above, below = rows[at], rows[at + 1]
        length = math.hypot(abs(above[at]), abs(below[at])) or 1.0
        c, s = above[at] / length, below[at] / length
        cc, sc = c.conjugate(), s.conjugate()
        rows[at] = above[:at] + [cc * a + sc * b for a, b in zip(above[at:], below[at:])]
        rows[at + 1] = below[:at] + [c * b - s * a for a, b in zip(above[at:], below[at:])]
        turns.append((c, s))
    for at, (c, s) in enumerate(turns):
        cc, sc = c.conjugate(), s.conjugate()
        for row in rows[: at + 2]:
            a, b = row[at], row[at + 1]
            row[at], row[at + 1] = a * c + b * s, b * cc - a * sc
    for at in range(count):
        rows[at][at] += shift
    return rows
