//! What several test files need. The promises themselves are the `[[test]]` targets beside this file.
