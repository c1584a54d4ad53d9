//! Evidence about reflection functions: closures in, verdicts out
