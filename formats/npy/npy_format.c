/* The drivers of NumPy's files: their names and their readers. */
#include "formats/npy/npy_format.h"

const cwi_format_driver cwi_format_npy = {
    .name = "npy",
    .extensions = ".npy",
    .about = "NumPy array of 2 to 4 dimensions, z y x",
    .volume = {.sniff = cwi_npy_sniff, .parse = cwi_npy_parse},
};

const cwi_format_driver cwi_format_npz = {
    .name = "npz",
    .extensions = ".npz",
    .about = "NumPy arrays in a zip archive: 'probabilities', or another one",
    .volume = {.sniff = cwi_npz_sniff, .parse = cwi_npz_parse},
};
