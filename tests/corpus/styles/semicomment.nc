%
O1000
G21 G90 G54 ; safe start
G0 X1. Y1.
M30
%
