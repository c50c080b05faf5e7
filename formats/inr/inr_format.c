/* INRIMAGE-4: what is read and written, and by whom. */
#include "formats/driver/format_driver.h"

const cwi_format_driver cwi_format_inr = {
    .name = "inr",
    .extensions = ".inr .inr.gz",
    .about = "INRIMAGE-4 volume, plain or gzipped",
    .volume = {.gzipped = true, .sniff = cwi_inr_sniff, .parse = cwi_inr_parse},
};
