%
O1000;
G21 G90 G54;
G0 X1. Y1. ;
G1 X2. F100. ; (comment)
M30;
%
