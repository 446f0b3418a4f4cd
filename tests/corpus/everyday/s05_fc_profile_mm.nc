%
O1010
(Exported by FreeCAD)
(Post Processor: fanuc_post)
(Output Time:2024-05-02 10:11:12)
(Begin preamble)
G17 G54 G40 G49 G80 G90
G21
(Begin operation: TC: 5mm Endmill)
(TC: 5mm Endmill)
M05
M06 T1
G43 H1
M03 S8000
(Finish operation: TC: 5mm Endmill)
(Begin operation: Profile)
G0 Z15.000
G0 X-7.500 Y0.000
G0 Z3.000
G1 X-7.500 Y0.000 Z-3.000 F180.000
G1 X-7.500 Y20.000 F480.000
G2 X0.000 Y27.500 I7.500 J0.000 K0.000
G1 X30.000 Y27.500
G2 X37.500 Y20.000 I0.000 J-7.500 K0.000
G1 X37.500 Y0.000
G2 X30.000 Y-7.500 I-7.500 J0.000 K0.000
G1 X0.000 Y-7.500
G2 X-7.500 Y0.000 I0.000 J7.500 K0.000
G0 Z15.000
(Finish operation: Profile)
(Begin postamble)
M05
G17 G54 G90 G80 G40
M30
%
