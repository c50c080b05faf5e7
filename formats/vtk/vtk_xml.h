/* What VTK's XML files of every kind have in common: how numbers are written, arrays, and data
 * appended behind the elements. */
#ifndef FORMATS_VTK_VTK_XML_H
#define FORMATS_VTK_VTK_XML_H

#include "formats/text/text_header.h"
#include "formats/text/xml.h"
#include "formats/volume/voxel_source.h"

typedef enum cwi_vtk_form { CWI_VTK_ASCII, CWI_VTK_BINARY, CWI_VTK_APPENDED } cwi_vtk_form;

typedef enum cwi_vtk_compressor { CWI_VTK_PLAIN, CWI_VTK_ZLIB, CWI_VTK_LZ4 } cwi_vtk_compressor;

/* Whether a VTKFile element starts in the first bytes of a file, with this word in its tag. */
bool cwi_vtk_xml_sniff(const unsigned char *head, size_t size, const char *word);

/* What the attributes of VTKFile and AppendedData say. */
typedef struct cwi_vtk_xml {
    bool has_order, big_endian;
    size_t word_bytes; /* of the sizes in front of binary data */
    cwi_vtk_compressor compressor;
    bool has_appended;
    bool base64;       /* the appended data are text */
    uint64_t appended; /* where they start: behind the underscore */
} cwi_vtk_xml;

typedef struct cwi_vtk_array {
    char name[CWI_WORD_BYTES], type_name[CWI_WORD_BYTES];
    bool is_known; /* of a type that is read */
    cw_type type;
    bool wide; /* of whole numbers of 64 bits: type is that of their halves */
    size_t components;
    cwi_vtk_form form;
    uint64_t offset;     /* in the appended data */
    uint64_t start, end; /* of its text in the file */
} cwi_vtk_array;

/* The elements, each filling in what its attributes say. kind names the only one read, and what
 * it is: {"ImageData", "a volume"}. */
CW_NODISCARD cw_status cwi_vtk_xml_file(cwi_vtk_xml *v, cwi_attributes a,
                                        const char *const kind[2], cw_error *err);
CW_NODISCARD cw_status cwi_vtk_xml_array(cwi_vtk_array *array, cwi_attributes a, cw_error *err);
CW_NODISCARD cw_status cwi_vtk_xml_appended(cwi_vtk_xml *v, cwi_attributes a, cw_error *err);

/* A whole number; *out stays as it is where there is no such attribute. */
CW_NODISCARD cw_status cwi_vtk_xml_integer(cwi_attributes a, const char *name, int64_t low,
                                           int64_t high, int64_t *out, cw_error *err);

/* Behind the last element: finds the appended data, and that the file goes on to its end. */
CW_NODISCARD cw_status cwi_vtk_xml_find_appended(const cwi_input *in, cwi_vtk_xml *v,
                                                 cw_error *err);

/* Sets where and how the numbers of an array are written; the source's sizes are set already.
 * Returns CW_ERR_FORMAT when what it needs is missing, or the file counts other bytes
 * for it. */
CW_NODISCARD cw_status cwi_vtk_xml_place(const cwi_vtk_xml *v, const cwi_vtk_array *array,
                                         const cwi_input *in, cwi_source *src, cw_error *err);

/* Describes an array of so many tuples, for cwi_tuples_load(). field is where the file counts
 * them; an array of NULL is missing. In text numbers of 64 bits are numbers like any other. */
CW_NODISCARD cw_status cwi_vtk_xml_tuples(const cwi_vtk_xml *v, const cwi_vtk_array *array,
                                          const char *field, size_t count, const cwi_input *in,
                                          cwi_source *src, bool *wide, cw_error *err);

#endif
