//! Error-controlled integration with dense output and located events; knows no physics.
