/* The driver of NIfTI-1 and NIfTI-2: its names, its reader and its writer. */
#include "formats/nifti/nifti_format.h"

const cwi_format_driver cwi_format_nifti = {
    .name = "nifti",
    .extensions = ".nii .nii.gz .hdr",
    .about = "NIfTI volume, plain or gzipped",
    .lost = "the frame beyond single precision",
    .keeps = CW_KEEPS_LABELS,
    .volume = {.extensions = ".nii .nii.gz .hdr .hdr.gz .img .img.gz",
               .gzipped = true,
               .sniff = cwi_nifti_sniff,
               .parse = cwi_nifti_parse},
    .save = {.extensions = ".nii .nii.gz", .has_scaling = true, .save = cwi_nifti_save},
};
