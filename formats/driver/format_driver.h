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
    const char *extensions; /* NULL: those of the format */
    bool gzipped;           /* the whole file may be a gzip file */
    /* Returns true if a file with such a head has the format; NULL: the content cannot
     * decide. */
    bool (*sniff)(const unsigned char *head, size_t size);
    /* Returns true if a folder is a volume of the format as a whole, not of slices. */
    bool (*is_store)(const cwi_input *folder);
    /* Reads a header, from which voxels are then loaded. */
    cw_status (*parse)(const cwi_input *in, cwi_source *src, cw_error *err);
    /* Reads an irregular grid; *is_grid is false where the file holds something else. */
    cw_status (*read_grid)(const cwi_input *in, const cw_read_desc *desc, bool *is_grid,
                           cw_volume *volume, cw_error *err);
    /* Reads one file as a whole. */
    cw_status (*read_file)(const cwi_input *in, const cw_read_desc *desc, cw_volume *volume,
                           cw_error *err);
    /* Reads slices in files of their own. */
    cw_status (*read_slices)(const cwi_input *in, cwi_names *names, const cw_read_desc *desc,
                             cw_volume *volume, cw_error *err);
    /* Lists the series of a folder. */
    cw_status (*list_series)(const cwi_input *in, cwi_names *names, const cw_read_desc *desc,
                             cw_series **series, size_t *count, cw_error *err);
    /* Lists the sizes in which a file holds its volume; NULL: there is one alone. */
    cw_status (*list_levels)(const cwi_input *in, const cw_read_desc *desc, cw_level **levels,
                             size_t *count, cw_error *err);
    bool holds_pages;  /* slices: a file with several pages is a volume */
    bool tells_arrays; /* its reader itself reports which of several arrays it took */
    bool needs_points; /* it is the format of files whose points are in another file */
} cwi_volume_reading;

typedef struct cwi_volume_writing {
    const char *extensions; /* extensions that are written */
    bool has_scaling;       /* slope and intercept have a place in the header */
    cw_status (*save)(const cwi_save *save, cw_error *err); /* NULL: it writes no volume */
} cwi_volume_writing;

typedef struct cwi_mesh_reading {
    cwi_mesh_sniffer *sniff; /* NULL: content cannot tell */
    bool sniffs_last;        /* the file's size decides, so other formats are tried first */
    cwi_mesh_reader *read;   /* NULL: it reads no mesh */
} cwi_mesh_reading;

typedef struct cwi_mesh_writing {
    cwi_mesh_writer *write;              /* NULL: it writes no mesh */
    cw_status (*prepare)(cw_error *err); /* finds its modules; NULL: nothing to find */
    /* Refuses requests that the format has no place for; NULL: nothing to refuse. */
    cw_status (*check)(const cw_write_desc *desc, cw_error *err);
    /* It writes a folder, and replaces an old one that passes this check; NULL: it writes a
     * file. */
    cwi_folder_check *replaces;
    bool own_axes;       /* unit and frame are those of the format */
    bool text;           /* it is text, or can be */
    bool compresses;     /* it has compressed forms */
    cw_compression only; /* it has this form alone */
    bool levels;         /* it has levels of detail */
    bool animates;       /* it can show parts one after another */
    bool sides;          /* it has labels on both sides of triangles */
    bool spools;         /* it can write a surface from a spool */
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

extern const cwi_format_driver cwi_format_nrrd, cwi_format_nifti, cwi_format_metaimage,
    cwi_format_vtk, cwi_format_vtu, cwi_format_vti, cwi_format_mrc, cwi_format_inr,
    cwi_format_dicom, cwi_format_tiff, cwi_format_zarr, cwi_format_vdb, cwi_format_plot3d,
    cwi_format_raw, cwi_format_glb, cwi_format_gltf, cwi_format_stl, cwi_format_ply,
    cwi_format_obj, cwi_format_off, cwi_format_3mf, cwi_format_vtp, cwi_format_drc,
    cwi_format_neuroglancer;

#endif
