//! The simulated machine: axes, kinematics, workpiece, chips, forces and vibrations.

mod cutting_forces;

mod fe;

mod blade;

mod chips;

mod end_mill_chips;

mod cutting_loads;

mod cutting_stock;

mod drives;

mod dynamics;

mod kinematics;

mod stability;

mod stock;

mod stock_fit;

mod one_run;
