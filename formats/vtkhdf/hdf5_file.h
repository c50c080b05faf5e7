/* The open file of the module "hdf5". All of it runs in a sandboxed process. */
#ifndef FORMATS_VTKHDF_HDF5_FILE_H
#define FORMATS_VTKHDF_HDF5_FILE_H

#include "formats/vtkhdf/vtkhdf.h"

#include <hdf5.h>
#if defined(__has_include) && __has_include(<H5FDdevelop.h>)
#include <H5FDdevelop.h> /* from version 1.14 on */
#endif

/* The open file, as the file driver reads it. */
typedef struct cwi_hdf5_bytes {
    H5FD_t base; /* first, as the library asks */
    int fd;      /* -1: none */
    haddr_t end, allocated;
} cwi_hdf5_bytes;

typedef struct cwi_hdf5_file {
    cwi_hdf5_bytes bytes;
    hid_t file, group;
    hid_t dataset; /* the open one; -1: none */
    uint32_t open_array;
    cwi_vtkhdf_facts facts;
} cwi_hdf5_file;

/* Opens the bytes of a file, to be read alone. It opens no other file. Returns -1 on failure. */
hid_t cwi_hdf5_open(cwi_hdf5_bytes *bytes);

/* Fails with what the library says of its last failure. subject: what was read, for the message */
cw_status cwi_hdf5_fail(const char *subject, cw_error *err);

/* Reads the attributes of the group VTKHDF, and lists its arrays. */
CW_NODISCARD cw_status cwi_hdf5_list(cwi_hdf5_file *f, cw_error *err);

/* Opens a dataset of a listed array, with a cache for the chunks of its next rows. */
CW_NODISCARD cw_status cwi_hdf5_open_array(cwi_hdf5_file *f, uint32_t array, cw_error *err);
void cwi_hdf5_close_array(cwi_hdf5_file *f);

/* Returns the type of numbers in memory; not to be closed. */
hid_t cwi_hdf5_type(uint32_t number);

#endif
