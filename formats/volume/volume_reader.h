/* The readers of volumes: functions that recognise the formats, and functions that read
 * them. */
#ifndef FORMATS_VOLUME_VOLUME_READER_H
#define FORMATS_VOLUME_VOLUME_READER_H

#include "formats/volume/voxel_source.h"

/* Recognise a format by a file's head, inflated if it is a gzip file. size is at most
 * CWI_SNIFF_BYTES. */
enum { CWI_SNIFF_BYTES = 512 };
bool cwi_nrrd_sniff(const unsigned char *head, size_t size);
bool cwi_nifti_sniff(const unsigned char *head, size_t size);
bool cwi_metaimage_sniff(const unsigned char *head, size_t size);
bool cwi_vtk_sniff(const unsigned char *head, size_t size);
bool cwi_vtu_sniff(const unsigned char *head, size_t size);
bool cwi_vti_sniff(const unsigned char *head, size_t size);
bool cwi_mrc_sniff(const unsigned char *head, size_t size);
bool cwi_inr_sniff(const unsigned char *head, size_t size);
bool cwi_dicom_sniff(const unsigned char *head, size_t size);
bool cwi_tiff_sniff(const unsigned char *head, size_t size);
bool cwi_vdb_sniff(const unsigned char *head, size_t size);

/* Stretches the axes to the spacing that a description states; directions and origin stay. */
void cwi_set_spacing(cw_volume *v, const cw_read_desc *desc);

/* Reports a finding or decision to the reader's caller. */
void cwi_note(const cw_read_desc *desc, const char *format, ...) CW_PRINTF(2, 3);

/* Reports the number of links in a folder that were left out, if there are any. */
void cwi_note_links(const cw_read_desc *desc, size_t links);

/* Reads a header into a zeroed source, which the caller frees in any case. The messages name
 * the header's fields; the caller puts the file's name in front. */
CW_NODISCARD cw_status cwi_nrrd_parse(const cwi_input *in, cwi_source *src, cw_error *err);
CW_NODISCARD cw_status cwi_nifti_parse(const cwi_input *in, cwi_source *src, cw_error *err);
CW_NODISCARD cw_status cwi_metaimage_parse(const cwi_input *in, cwi_source *src, cw_error *err);
CW_NODISCARD cw_status cwi_vtk_parse(const cwi_input *in, cwi_source *src, cw_error *err);
CW_NODISCARD cw_status cwi_vti_parse(const cwi_input *in, cwi_source *src, cw_error *err);
CW_NODISCARD cw_status cwi_mrc_parse(const cwi_input *in, cwi_source *src, cw_error *err);
CW_NODISCARD cw_status cwi_inr_parse(const cwi_input *in, cwi_source *src, cw_error *err);

/* Reads an irregular grid; *is_grid is false when the file holds something else, which
 * cwi_..._parse() can then read. */
CW_NODISCARD cw_status cwi_vtk_read_grid(const cwi_input *in, const cw_read_desc *desc,
                                         bool *is_grid, cw_volume *volume, cw_error *err);
CW_NODISCARD cw_status cwi_vtu_read(const cwi_input *in, const cw_read_desc *desc,
                                    bool *is_grid, cw_volume *volume, cw_error *err);

/* Reads slices in separate files, by a library in a sandbox.
 * in     the folder, or one file and its folder
 * names  of the files, sorted; NULL: in's own file */
CW_NODISCARD cw_status cwi_dicom_read(const cwi_input *in, cwi_names *names,
                                      const cw_read_desc *desc, cw_volume *volume,
                                      cw_error *err);
CW_NODISCARD cw_status cwi_tiff_read(const cwi_input *in, cwi_names *names,
                                     const cw_read_desc *desc, cw_volume *volume,
                                     cw_error *err);

/* Reads one file by a library in a sandbox. */
CW_NODISCARD cw_status cwi_vdb_read(const cwi_input *in, const cw_read_desc *desc,
                                    cw_volume *volume, cw_error *err);

/* Recognise, read and list the levels of a store of Zarr: its folder, or a metadata file in
 * it. */
bool cwi_zarr_is_store(const cwi_input *folder);
CW_NODISCARD cw_status cwi_zarr_read(const cwi_input *in, const cw_read_desc *desc,
                                     cw_volume *volume, cw_error *err);
CW_NODISCARD cw_status cwi_zarr_levels(const cwi_input *in, const cw_read_desc *desc,
                                       cw_level **levels, size_t *count, cw_error *err);

/* Reads one file and the one that desc->points names. */
CW_NODISCARD cw_status cwi_plot3d_read(const cwi_input *in, const cw_read_desc *desc,
                                       cw_volume *volume, cw_error *err);

CW_NODISCARD cw_status cwi_dicom_list(const cwi_input *in, cwi_names *names,
                                      const cw_read_desc *desc, cw_series **series,
                                      size_t *count, cw_error *err);

/* Makes a source from a layout that the caller of the library states. */
CW_NODISCARD cw_status cwi_raw_describe(const cw_raw_layout *layout, cwi_source *src,
                                        cw_error *err);

#endif
