//! A blade that gives way while its side is finished: stiffness seen from the contact, the nominal surface, marks, damping.

mod contact;

mod edges;

mod small;

mod surface;
