//! The supervisor, from outside: one test per arrow of its diagram, one per row of the policy, the operator's rights, a random walk, and the
//! times that `docs/safety.md` quotes.

mod bench;

mod document;

mod arrows;

mod policy;

mod operator;

mod walk;

mod figures;
