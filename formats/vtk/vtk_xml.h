/* The common parts of VTK's XML files of every kind: encodings of numbers, arrays, and data
 * appended behind the elements. */
#ifndef FORMATS_VTK_VTK_XML_H
#define FORMATS_VTK_VTK_XML_H

#include "formats/text/text_header.h"
#include "formats/text/xml.h"
#include "formats/volume/voxel_source.h"

typedef enum cwi_vtk_form { CWI_VTK_ASCII, CWI_VTK_BINARY, CWI_VTK_APPENDED } cwi_vtk_form;

typedef enum cwi_vtk_compressor { CWI_VTK_PLAIN, CWI_VTK_ZLIB, CWI_VTK_LZ4 } cwi_vtk_compressor;

/* Returns true if a VTKFile element starts in the first bytes of a file, with this word in its
 * tag. */
bool cwi_vtk_xml_sniff(const unsigned char *head, size_t size, const char *word);

/* The attributes of VTKFile and AppendedData. */
typedef struct cwi_vtk_xml {
    bool has_order, big_endian;
    size_t word_bytes; /* of the sizes before binary data */
    cwi_vtk_compressor compressor;
    bool has_appended;
    bool base64;       /* the appended data are text */
    uint64_t appended; /* start of the data: behind the underscore */
} cwi_vtk_xml;

typedef struct cwi_vtk_array {
    char name[CWI_WORD_BYTES], type_name[CWI_WORD_BYTES];
    bool is_known; /* its type can be read */
    cw_type type;
    cwi_stored stored;
    size_t components;
    cwi_vtk_form form;
    uint64_t offset;     /* in the appended data */
    uint64_t start, end; /* of its text in the file */
} cwi_vtk_array;

/* Parses the attributes of one element each. kind: the only kind that is read, and its
 * description: {"ImageData", "a volume"}. */
CW_NODISCARD cw_status cwi_vtk_xml_file(cwi_vtk_xml *v, cwi_attributes a,
                                        const char *const kind[2], cw_error *err);
CW_NODISCARD cw_status cwi_vtk_xml_array(cwi_vtk_array *array, cwi_attributes a, cw_error *err);
CW_NODISCARD cw_status cwi_vtk_xml_appended(cwi_vtk_xml *v, cwi_attributes a, cw_error *err);

/* Parses a whole number; *out is unchanged where there is no such attribute. */
CW_NODISCARD cw_status cwi_vtk_xml_integer(cwi_attributes a, const char *name, int64_t low,
                                           int64_t high, int64_t *out, cw_error *err);

/* Finds the appended data behind the last element, and checks that the file goes on to its
 * end. */
CW_NODISCARD cw_status cwi_vtk_xml_find_appended(const cwi_input *in, cwi_vtk_xml *v,
                                                 cw_error *err);

/* Sets place and encoding of an array's numbers; the source's sizes are already set.
 * Returns CW_ERR_FORMAT when a needed attribute is missing, or the file states another count of
 * bytes for it. */
CW_NODISCARD cw_status cwi_vtk_xml_place(const cwi_vtk_xml *v, const cwi_vtk_array *array,
                                         const cwi_input *in, cwi_source *src, cw_error *err);

/* Describes an array of `count` tuples, for cwi_tuples_load(). field: name of the count in the
 * file. An array of NULL is missing. In text, numbers of 64 bits are ordinary numbers. */
CW_NODISCARD cw_status cwi_vtk_xml_tuples(const cwi_vtk_xml *v, const cwi_vtk_array *array,
                                          const char *field, size_t count, const cwi_input *in,
                                          cwi_source *src, bool *wide, cw_error *err);

/* Describes an array of `count` tuples whose numbers become those of voxels. */
CW_NODISCARD cw_status cwi_vtk_xml_values(const cwi_vtk_xml *v, const cwi_vtk_array *array,
                                          const char *field, size_t count, const cwi_input *in,
                                          cwi_source *src, cw_error *err);

#endif
