/* The driver of a format: its names, its readers and its writers. Every folder of a format
 * defines a constant of this type; formats/format_registry.c lists them. */
#ifndef FORMATS_DRIVER_FORMAT_DRIVER_H
#define FORMATS_DRIVER_FORMAT_DRIVER_H

#include "formats/mesh/mesh_reader.h"
#include "formats/mesh/mesh_writer.h"
#include "formats/volume/volume_reader.h"
#include "formats/volume/volume_writer.h"

/* Reads volumes by one of parse, read_grid, read_file and read_slices; all NULL: it reads none. */
typedef struct cwi_volume_reading {
    const char *extensions;    /* NULL: those of the format */
    bool gzipped;              /* the whole file may be a gzip file */
    cwi_volume_sniffer *sniff; /* NULL: the content cannot decide */
    /* Returns true if a folder is a volume of the format as a whole, not of slices. */
    bool (*is_store)(const cwi_input *folder);
    cwi_header_parser *parse;
    cwi_grid_reader *read_grid;
    cwi_volume_reader *read_file;
    cwi_slices_reader *read_slices;
    cwi_series_lister *list_series;
    cwi_level_lister *list_levels; /* NULL: there is one size alone */
    bool holds_pages;              /* slices: a file with several pages is a volume */
    bool tells_arrays; /* its reader itself reports which of several arrays it took */
    bool needs_points; /* it is the format of files whose points are in another file */
} cwi_volume_reading;

typedef struct cwi_volume_writing {
    const char *extensions; /* extensions that are written */
    bool has_scaling;       /* slope and intercept have a place in the header */
    cwi_volume_saver *save; /* NULL: it writes no volume */
} cwi_volume_writing;

typedef struct cwi_mesh_reading {
    cwi_mesh_sniffer *sniff; /* NULL: content cannot tell */
    bool sniffs_last;        /* the file's size decides, so other formats are tried first */
    cwi_mesh_reader *read;   /* NULL: it reads no mesh */
} cwi_mesh_reading;

/* Counts the vertices that a file has more than its parts, because each has one colour there. */
typedef cw_status cwi_split_counter(const cwi_parts *parts, const cw_write_desc *desc,
                                    size_t *added, cw_error *err);

typedef struct cwi_mesh_writing {
    const char *extensions; /* extensions that are written; NULL: those of the format */
    cwi_mesh_writer *write; /* NULL: it writes no mesh */
    cw_status (*prepare)(cw_error *err); /* finds its modules; NULL: nothing to find */
    /* Refuses requests that the format has no place for; NULL: nothing to refuse. */
    cw_status (*check)(const cw_write_desc *desc, cw_error *err);
    /* It writes a folder, and replaces an old one that passes this check; NULL: it writes a
     * file. */
    cwi_folder_check *replaces;
    bool own_axes; /* unit and frame are those of the format */
    bool ras_mm;   /* unit and frame are millimetres, right-anterior-superior, and no others */
    bool text;     /* it is text, or can be */
    unsigned text_lacks; /* properties that its text does not keep: cw_keeps flags */
    int color_bits;      /* of a channel of colours of faces, without opacity; 0: all */
    bool compresses;     /* it has compressed forms */
    cw_compression only; /* it has this form alone */
    bool levels;         /* it has levels of detail */
    bool animates;       /* it can show parts one after another */
    bool sides;          /* it has labels on both sides of triangles */
    bool one_coloring;   /* a mesh with colours of faces has none of vertices there */
    cwi_split_counter *count_split; /* NULL: colours of faces add no vertices */
    bool spools;                    /* it can write a surface from a spool */
    bool shares; /* each process of a team can write its records: in binary, all have a size */
} cwi_mesh_writing;

typedef struct cwi_format_driver {
    const char *name;       /* "nrrd" */
    const char *extensions; /* ".nrrd .nhdr" */
    const char *about;
    const char *feature; /* required feature, as named by `version --features`; NULL: none */
    const char *lost;    /* information that writing drops; NULL: nothing */
    unsigned keeps;      /* properties of a written mesh: cw_keeps flags */
    cwi_volume_reading volume;
    cwi_volume_writing save;
    cwi_mesh_reading mesh;
    cwi_mesh_writing write;
} cwi_format_driver;

#endif
