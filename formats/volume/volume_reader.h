/* The common parts of the readers of volumes: the kinds of functions that a format has. */
#ifndef FORMATS_VOLUME_VOLUME_READER_H
#define FORMATS_VOLUME_VOLUME_READER_H

#include "formats/volume/voxel_source.h"

enum { CWI_SNIFF_BYTES = 512 };

/* Returns true if a file with such a head has the format. The head is inflated if it is a gzip file;
 * size is at most CWI_SNIFF_BYTES. */
typedef bool cwi_volume_sniffer(const unsigned char *head, size_t size);

/* Reads a header into a zeroed source, which the caller frees in any case. The messages name
 * the header's fields; the caller puts the file's name in front. */
typedef cw_status cwi_header_parser(const cwi_input *in, cwi_source *src, cw_error *err);

/* Reads an irregular grid; *is_grid is false when the file holds something else, which a parser
 * of headers can then read. */
typedef cw_status cwi_grid_reader(const cwi_input *in, const cw_read_desc *desc, bool *is_grid,
                                  cw_volume *volume, cw_error *err);

/* Reads one file as a whole. */
typedef cw_status cwi_volume_reader(const cwi_input *in, const cw_read_desc *desc,
                                    cw_volume *volume, cw_error *err);

/* Reads slices in separate files, by a library in a sandbox.
 * in     the folder, or one file and its folder
 * names  of the files, sorted; NULL: in's own file */
typedef cw_status cwi_slices_reader(const cwi_input *in, cwi_names *names,
                                    const cw_read_desc *desc, cw_volume *volume, cw_error *err);

/* Lists the series of a folder. */
typedef cw_status cwi_series_lister(const cwi_input *in, cwi_names *names,
                                    const cw_read_desc *desc, cw_series **series, size_t *count,
                                    cw_error *err);

/* Lists the sizes in which a file holds its volume. */
typedef cw_status cwi_level_lister(const cwi_input *in, const cw_read_desc *desc,
                                   cw_level **levels, size_t *count, cw_error *err);

/* Stretches the axes to the spacing that a description states; directions and origin stay. */
void cwi_set_spacing(cw_volume *v, const cw_read_desc *desc);

/* Reports a finding or decision to the reader's caller. */
void cwi_note(const cw_read_desc *desc, const char *format, ...) CW_PRINTF(2, 3);

/* Reports the number of links in a folder that were left out, if there are any. */
void cwi_note_links(const cw_read_desc *desc, size_t links);

#endif
