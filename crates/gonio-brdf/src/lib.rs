//! Reflection functions: models, measured tables, and the registry
