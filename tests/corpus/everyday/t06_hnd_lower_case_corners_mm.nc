%
o1414 (lower case hand program)
g21 g90 g17 g40 g80
t2 m6 (endmill d16)
g54 g0 x-20. y-20. s2000 m3
g43 z50. h2
z2. m8
g1 z-5. f250.
g41 d2 x0. y0.
y50. ,r8.
x80. ,c5.
y0. ,r8.
x0.
g40 x-20. y-20.
g0 z50. m9
g28 g91 z0.
m30
%
