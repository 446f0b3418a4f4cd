%
O1000
'Program by me
G21 G90 G54 'safe start
M30
%
