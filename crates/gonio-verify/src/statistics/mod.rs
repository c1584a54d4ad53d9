//! Statistical tests with their p-values: the probability, if the hypothesis holds, of a statistic at least as extreme.

mod hypothesis;
mod image;
mod interval;
mod moments;

pub use hypothesis::{
    TestResult, chi_square_test, chi_square_test_with_slack, kolmogorov_smirnov_uniform, sidak,
    sidak_p_value, t_test, welch_t_test, z_test,
};
pub use image::{ImageZTest, image_z_test};
pub use interval::{bernstein_deviation, clopper_pearson_upper, normal_quantile, wilson_interval};
pub use moments::Moments;
