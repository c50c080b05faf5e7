/* Opening of untrusted files: the header that a user names, and the data files that it
 * names. */
#ifndef FORMATS_BYTES_INPUT_FILE_H
#define FORMATS_BYTES_INPUT_FILE_H

#include <cubewright/formats.h>

/* An open file, and the folder in which it was named. */
typedef struct cwi_input {
    const char *path; /* borrowed */
    int folder;       /* folder of the side files, or -1 for a file without a path */
    int fd;
    uint64_t size;                 /* number of bytes that the system reports */
    bool allow_external;           /* side files may lie elsewhere */
    const char *array;             /* name of the wanted array; NULL: any */
    struct cwi_array_list *arrays; /* list that readers fill with the arrays; NULL: not
                                      wanted */
    cw_label_table *labels; /* empty table that readers fill with the names of labels; NULL: not
                               wanted */
    struct cwi_slice_visit *visit; /* slices are wanted in place of all voxels; else NULL */
} cwi_input;

/* Opens the file that a user named. Links are followed, as the user may have made them.
 * Returns CW_ERR_IO when it is missing, empty, unreadable or anything but a regular file. */
CW_NODISCARD cw_status cwi_input_open(cwi_input *in, const char *path, cw_error *err);
void cwi_input_close(cwi_input *in);

/* Opens a file that has no path. It has no side files: those that it names are
 * CW_ERR_UNSUPPORTED. Returns CW_ERR_IO. */
CW_NODISCARD cw_status cwi_input_open_stored(cwi_input *in, const cw_stored_file *file,
                                             cw_error *err);

/* Returns true for an open file that has no path. */
bool cwi_input_is_stored(const cwi_input *in);

/* Returns the name of a file for messages: that of the stored one, else the path. */
const char *cwi_input_name(const char *path, const cw_stored_file *file);

/* Opens a folder in which side files are found; there is no file. Returns CW_ERR_IO. */
CW_NODISCARD cw_status cwi_input_open_folder(cwi_input *in, const char *path, cw_error *err);

/* Returns true if a name in the folder is that of the open file. */
bool cwi_input_is_named(const cwi_input *in, const char *name);

/* Opens a file that the header names; the header itself is not opened again. Unless
 * in->allow_external it must lie in the header's folder or below. No absolute path, "..",
 * scheme or percent sign, and no link on the way is allowed. A backslash, as Windows writes it, is
 * taken as a slash. The caller closes the file.
 * Returns CW_ERR_UNSAFE for a name that leaves the folder, CW_ERR_UNSUPPORTED beside a file without a
 * path, else as cwi_input_open(). */
CW_NODISCARD cw_status cwi_input_open_side(const cwi_input *in, const char *name, int *fd,
                                           uint64_t *size, cw_error *err);

/* Opens a side file as cwi_input_open_side() does, if it exists. Sets *fd to -1 where it or its
 * folder is missing. */
CW_NODISCARD cw_status cwi_input_find_side(const cwi_input *in, const char *name, int *fd,
                                           uint64_t *size, cw_error *err);

/* Reads up to size bytes at an offset; *got is less only where the file ends. */
CW_NODISCARD cw_status cwi_input_read_at(int fd, uint64_t offset, void *to, size_t size,
                                         size_t *got, cw_error *err);

/* Names of side files, in the order of their voxels. A zeroed one is empty. */
typedef struct cwi_names {
    char **items;
    size_t count;
} cwi_names;

CW_NODISCARD cw_status cwi_names_add(cwi_names *names, const char *name, cw_error *err);

/* Adds the names of the pattern "PATTERN FIRST LAST STEP [DEPTH]": one %d, %3d or %03d, a step
 * that leads to the last number, up or down. *depth gets the last number, or stays unchanged when there is none. */
CW_NODISCARD cw_status cwi_names_expand(cwi_names *names, const char *text, int64_t *depth,
                                        cw_error *err);
void cwi_names_free(cwi_names *names);

#endif
