//! A flexible blade while its side is finished: stiffness seen from the contact, the nominal surface, marks, damping.

mod contact;

mod edges;

mod small;

mod surface;
