/* The driver of DICOM: its reader and the list of series. */
#include "formats/dicom/dicom_format.h"

const cwi_format_driver cwi_format_dicom = {
    .name = "dicom",
    .extensions = ".dcm .dicom .ima",
    .about = "DICOM series: a folder, or any file of it",
    .feature = "dicom",
    .volume = {.sniff = cwi_dicom_sniff,
               .read_slices = cwi_dicom_read,
               .list_series = cwi_dicom_list},
};
