/* The files of a user's path that names more than one: a folder, or a pattern such as
 * 'scan/slice_*.tif'. */
#ifndef FORMATS_BYTES_FILE_PATTERN_H
#define FORMATS_BYTES_FILE_PATTERN_H

#include "formats/bytes/input_file.h"

/* Compares as strcmp(), but numbers in names by their value: slice_9 comes before slice_10, and s_-2
 * before s_1: a minus behind an underscore, a blank or a bracket is a sign. */
int cwi_natural_order(const char *a, const char *b);

/* Returns true if a path contains one of * ? [ and no file has that very name. */
bool cwi_files_is_pattern(const char *path);

/* Opens the folder of a path, or the folder from which a pattern starts. Adds its files in
 * natural order: those in the folder and, if deep, below it; or those that match. Hidden files
 * are left out. So are links unless external files are allowed (*links counts them). The names
 * are for cwi_input_open_side(). Close in with cwi_input_close(). Returns CW_ERR_IO when the
 * folder cannot be opened, or nothing matches; CW_ERR_LIMIT for more than 65,536 files or
 * folders nested deeper than 16. */
CW_NODISCARD cw_status cwi_files_find(cwi_input *in, const char *path, bool deep,
                                      cwi_names *names, size_t *links, cw_error *err);

/* Puts names into natural order. Where names are alike only if a minus behind a letter is a sign, as in
 * s-1 and s1, it is taken as one. */
void cwi_files_sort(cwi_names *names);

/* Adds the files in the folder of an open input, its own among them, and none below; *links
 * counts those left out. */
CW_NODISCARD cw_status cwi_files_beside(const cwi_input *in, cwi_names *names, size_t *links,
                                        cw_error *err);

/* Finds the numbers in names that are alike except for one number. Returns false where they are
 * not, or where the number has more than 15 digits. */
bool cwi_files_numbers(const cwi_names *names, double *numbers);

bool cwi_is_folder(const char *path);

/* Returns true if a path ends in one of the blank-separated extensions, in any letter case. */
bool cwi_has_extension(const char *path, const char *extensions);

#endif
