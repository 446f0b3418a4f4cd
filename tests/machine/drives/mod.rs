//! Motion of axes that are all limited in speed, acceleration and jerk, measured from their positions a millisecond apart
//! and compared with closed forms.

mod motion;

mod closed_forms;

mod limits;

mod panel;

mod contour;

mod indexing;

mod example;

mod servo;

mod runs;

mod spindle;
