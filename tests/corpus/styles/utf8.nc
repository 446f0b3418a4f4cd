%
O1000 (Fräser Ø10 – Tasche)
(Bohrung „groß“)
G90 G54
G0 X1. Y1.
M30
%
