%
o1000 (lower case)
n10 g21 g90 g54
t1 m6
s3000 m3
g0 x0 y0
g43 h1 z5.
g1 z-1. f100.
x10.
g2 x20. y10. i0 j10.
g0 z50.
m30
%
