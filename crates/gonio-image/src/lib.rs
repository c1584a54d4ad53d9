//! Pictures of light: pixel buffers, EXR, Radiance HDR, PNG, JPEG, tone mapping and differences
