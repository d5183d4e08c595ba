//! The metrics, one file each.

pub(crate) mod ciede2000;
pub(crate) mod entropy;
pub(crate) mod features;
pub(crate) mod illumination_residual;
pub(crate) mod light_uniformity;
pub(crate) mod psnr;
pub(crate) mod sequence;
pub(crate) mod ssim;
pub(crate) mod uciqe;
pub(crate) mod uicm;
pub(crate) mod uiconm;
pub(crate) mod uiqm;
pub(crate) mod uism;
