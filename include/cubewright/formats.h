/* Reading and writing of files: volumes, meshes, series of slices and of time steps. Bytes in memory
 * and streams are read and written as files are: see cw_volume_read_memory(), cw_mesh_write_memory(). */
#ifndef CUBEWRIGHT_FORMATS_H
#define CUBEWRIGHT_FORMATS_H

#include <cubewright/label_table.h>
#include <cubewright/mesh.h>
#include <cubewright/picture.h>
#include <cubewright/spool.h>
#include <cubewright/stored_file.h>
#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The layout of a file without a header. */
typedef struct cw_raw_layout {
    size_t dim[3];     /* required */
    cw_type type;      /* default CW_U8 */
    size_t components; /* 0 means 1; interleaved */
    size_t steps;      /* 0 means 1 */
    bool big_endian;   /* default: little-endian */
    uint64_t offset;   /* number of bytes before the first voxel */
    double spacing[3]; /* mm; all 0 means 1 each, and the unit is then unknown */
    size_t
        stored_bytes; /* of a number in the file: 8 for integers of 64 bits that fit CW_I32 or
                            CW_U32, 2 for floats of 16 bits (CW_F32); default: as the type */
} cw_raw_layout;

/* The policy for slices that are missing or not at equal distances. */
typedef enum cw_gaps {
    CW_GAPS_STOP,        /* CW_ERR_UNSAFE */
    CW_GAPS_INTERPOLATE, /* make slices at equal distances from the nearest two */
    CW_GAPS_ALLOW        /* take the slices as if they were at equal distances */
} cw_gaps;

/* The policy for slices that are shifted against each other, as a tilted gantry leaves them. */
typedef enum cw_tilt {
    CW_TILT_CORRECT, /* leave them where they are: the frame is sheared */
    CW_TILT_KEEP     /* stack them up as if they were not shifted */
} cw_tilt;

/* Units of coordinates in files: constant, name, millimetres. */
#define CW_UNIT_TABLE(X)                                                                       \
    X(CW_UNIT_MM, "mm", 1)                                                                     \
    X(CW_UNIT_UM, "um", 1e-3)                                                                  \
    X(CW_UNIT_CM, "cm", 10)                                                                    \
    X(CW_UNIT_M, "m", 1000)                                                                    \
    X(CW_UNIT_IN, "in", 25.4)                                                                  \
    X(CW_UNIT_FT, "ft", 304.8)

/* A unit of coordinates. */
typedef enum cw_unit {
#define CW_UNIT_ENUM(constant, name, mm) constant,
    CW_UNIT_TABLE(CW_UNIT_ENUM)
#undef CW_UNIT_ENUM
        CW_UNIT_COUNT
} cw_unit;

/* Returns the name of a unit, such as "cm", and its millimetres. */
CW_API const char *cw_unit_name(cw_unit unit);
CW_API double cw_unit_mm(cw_unit unit);

/* The meaning of coordinates in a file. Zeroed: LPS millimetres, +Z up. */
typedef struct cw_axes {
    cw_unit unit; /* default: millimetres */
    bool ras;     /* x to the right and y to the front; default: to the left and to the back */
    bool y_up;    /* (x, y, z) stands as (x, z, -y) */
} cw_axes;

/* The rule for a file that contradicts its reader's caller. */
typedef enum cw_claim_rule {
    CW_CLAIM_AGREE,   /* CW_ERR_ARGUMENT */
    CW_CLAIM_FILL,    /* the file's statement counts */
    CW_CLAIM_OVERRIDE /* the caller's statement counts */
} cw_claim_rule;

/* The caller's statement on coordinates in a file that may name neither unit nor frame. An
 * OpenVDB file, for example, is by custom in metres and y-up. Zeroed: no statement. */
typedef struct cw_claim {
    bool has_unit, has_frame, has_up; /* which of these are stated */
    cw_axes axes;                     /* unit; ras; y_up */
    cw_claim_rule rule;               /* where the file says something else */
} cw_claim;

/* Voxels that have no value. They are no part of a surface, nor of what borders it. */
typedef enum cw_nodata {
    CW_NODATA_FILE,  /* those that the file names, as DICOM's padding */
    CW_NODATA_NONE,  /* none but NaN: the file's padding counts as values */
    CW_NODATA_VALUE, /* those of one value, in place of the file's */
} cw_nodata;

/* Options of reading a volume. Zero-initialise the struct; a zero field means the default named
 * beside it. */
typedef struct cw_read_desc {
    uint32_t version;         /* 0: the first version of this struct */
    const char *reader;       /* a name of cw_formats(); default: by content, then extension */
    const cw_raw_layout *raw; /* read as headerless bytes laid out so; default: by header */
    bool header_only;         /* leave data NULL and fill in everything else; for an irregular
                                 grid neither points nor corners */
    bool allow_external;      /* data files outside the header's folder; default: refused */
    const cw_box *region;     /* read only these voxels, x y z; default: all */
    size_t every[3];          /* of these, every n-th along x, y and z, as cw_volume_coarsen();
                                 the voxels between them take little memory; default: 1, all */
    uint64_t max_voxels;      /* default 2^40 */
    uint64_t max_bytes;       /* of voxels in memory; for an irregular grid all memory of
                                 reading it; default: no limit */
    double spacing_mm[3];     /* instead of the file's; default: all 0, the file's */
    cw_claim claim;           /* on the file's coordinates; default: as the file states, else
                                 LPS mm */
    const char *array;        /* the name, where files have several; default: the array that the
                                 file names, else the first of one value */

    size_t level; /* of a volume that the file holds in several sizes, as OME-Zarr, N5 and
                     Neuroglancer do; default: 0, the finest */

    cw_label_table *labels; /* zeroed or filled; freed first, then filled with the names and
                               colours of labels that the file holds; free it with
                               cw_label_table_free(); default: not kept */

    const char *points; /* for a PLOT3D solution: the file of its grid's points; marks it as
                           one */

    /* Slices in files of their own (TIFF, PNG, BMP, DICOM). */
    const char *series; /* label or UID, as from cw_series_list(); default: the only one */
    cw_gaps gaps;       /* missing or uneven slices; default: CW_ERR_UNSAFE */
    cw_tilt tilt;       /* shifted slices; default: they stay where they are */
    bool skip_damaged; /* leave out slices whose files are damaged, with a note; what they leave
                           are gaps. To find them, compressed pixels are decoded once more.
                           Default: the error of the file. Files that belong to another series
                           than the chosen one, or may do so, are left out in any case */

    /* Libraries run in a sandboxed process without rights, so a file that breaks one breaks
     * nothing else. */
    bool no_sandbox;  /* run them in this process instead */
    double timeout_s; /* for one file; default 60 */

    /* Called on the calling thread with one line for each finding and decision: a tilt, slices
     * left out, the choice among several arrays. Default: none. */
    void (*note)(void *user, const char *text);
    void *note_user;      /* passed to note */
    cw_progress progress; /* default: none */

    cw_nodata nodata; /* default: as the file says */
    double
        nodata_value; /* for CW_NODATA_VALUE: a value as the volume has it, slope and intercept
                            applied; CW_ERR_ARGUMENT if voxels of its type cannot have it */

    cw_label_ids
        *ids; /* for a label map: zeroed, or from cw_label_ids_read(). Freed first, then
                          filled; voxels of labels below 0, or beyond 32 bits, become CW_U32 places
                          in it. cw_volume_visit() takes it as it is. Default: integers of 64 bits that
                          do not fit 32 are CW_ERR_FORMAT */
    bool round_labels; /* with ids: values that are not whole are rounded to the nearest, and
                          counted in it. Default: CW_ERR_ARGUMENT, naming the voxel */

    const cw_stored_file *stored; /* the bytes to read, in place of those at the path, which may
                                     then be NULL; default: none */
} cw_read_desc;

/* Reads a volume: the whole file or a region of it, every component and time step.
 *
 * path is a file, a folder of slices, a pattern such as "scan/slice_*.tif" that names them, or
 * the folder of a Zarr or N5 store, or of a precomputed volume of Neuroglancer.
 * Numbers in their names count as numbers. With a layout (raw), each slice has an equal share
 * of the voxels. A DICOM file stands for its whole series, as far as it is in the same folder.
 *
 * The header is checked against the file's true size before anything is allocated. Voxels keep
 * their type and numbers; only the byte order is converted. Direction, origin and spacing are
 * stored in the affine as the file states them, turned to LPS millimetres.
 *
 * A region is the part that cw_volume_crop() would leave of the whole; only it takes memory.
 * The file is read up to the region's last voxel. Unwanted uncompressed data are skipped,
 * compressed data are inflated and dropped. The checksum at their end is verified only if the
 * region reaches it.
 *
 * From an irregular grid, cells of our four shapes are read; omissions are noted. Samples that
 * are the same in place and value to the bit become one. Values of cells are averaged around
 * each sample, to CW_F64. The header of such a grid counts samples as the file does.
 *
 * volume   filled on success, else emptied; free it with cw_volume_free(), a header's too
 * format   set to the reader's name (static); may be NULL
 * Returns  CW_ERR_IO           missing, not a regular file, unreadable
 *          CW_ERR_FORMAT       not understood, damaged, or truncated; names the field
 *          CW_ERR_UNSAFE       the header names voxels outside its own folder; an XML document
 *                              type; several series and none chosen; slices that are missing,
 *                              uneven, without a place, or shifted unevenly
 *          CW_ERR_UNSUPPORTED  compressed with a library that is not in this build; a region of
 *                              an irregular grid
 *          CW_ERR_BACKEND      a library crashed on the file, or took too long
 *          CW_ERR_LIMIT        more voxels or bytes than allowed; CW_ERR_NO_MEMORY
 *          CW_ERR_ARGUMENT     no such reader, array or level; a region that is empty or leaves the
 *                              volume; a spacing for an irregular grid, or beside the claim
 *                              of a unit; a claim that the file contradicts
 *          CW_ERR_CANCELLED */
CW_NODISCARD CW_API cw_status cw_volume_read(const char *path, const cw_read_desc *desc,
                                             cw_volume *volume, const char **format,
                                             cw_error *err);

/* Reads a volume from bytes in memory or from a function of the caller, with the limits, guards and
 * sandbox of files. The format is found by content, else by the extension of source->name.
 *
 * There are no files beside the bytes. Those that a header names are CW_ERR_UNSUPPORTED, and the
 * message names them: detached voxels of NRRD and MetaImage, pairs of NIfTI, pieces of VTK. So are a
 * file of Zarr, N5 or Neuroglancer, and one image of a DICOM series; DICOM of many frames is read.
 *
 * source   borrowed until the call returns
 * desc     as for cw_volume_read(); stored is not used
 * volume   filled on success, else emptied; free it with cw_volume_free()
 * format   set to the reader's name (static); may be NULL
 * Returns  as cw_stored_file_open() and cw_volume_read()
 * Cost     that of cw_volume_read(), and one copy of the bytes meanwhile */
CW_NODISCARD CW_API cw_status cw_volume_read_memory(const cw_byte_source *source,
                                                    const cw_read_desc *desc, cw_volume *volume,
                                                    const char **format, cw_error *err);

/* Finds the numbers of a label map's labels slice by slice, for a cw_volume_visit(): all components
 * of a step.
 *
 * desc     as for cw_volume_visit(); its ids are not used, round_labels is
 * step     that the slices have
 * ids      freed first, then filled; empty where voxels are the numbers of their labels
 * Returns  as cw_volume_visit(); CW_ERR_ARGUMENT: a value is no whole number, naming the voxel;
 *          CW_ERR_LIMIT: 2^32 - 1 labels
 * Cost     reading the voxels once, unless they have 32 bits without a sign */
CW_NODISCARD CW_API cw_status cw_label_ids_read(const char *path, const cw_read_desc *desc,
                                                size_t step, cw_label_ids *ids, cw_error *err);

/* A user of slices. A status other than CW_OK ends the visit, which then returns it. */
typedef struct cw_slice_visitor {
    /* Called once, on the calling thread; the source is valid during the call. */
    cw_status (*visit)(void *user, const cw_slice_source *source, cw_error *err);
    void *user; /* passed to visit */
} cw_slice_visitor;

/* Opens a volume for cw_extract_stream(): calls the visitor once, with a source that is valid
 * during the call. Voxels are read as the visitor asks for slices; those of compressed files are
 * inflated on the way. desc->max_bytes is for the whole and not used.
 *
 * component, step  that the slices have
 * visitor          borrowed
 * Returns          as cw_volume_read(), or what the visitor returned
 *                  CW_ERR_UNSUPPORTED  a format, or an order of its axes, whose slices are not read by
 *                                      themselves */
CW_NODISCARD CW_API cw_status cw_volume_visit(const char *path, const cw_read_desc *desc,
                                              size_t component, size_t step,
                                              const cw_slice_visitor *visitor,
                                              const char **format, cw_error *err);

/* Lists the files of a time series; each file is a volume and a step. Paths name files or
 * folders of slices; patterns stand for the files that match. Numbers in names count as
 * numbers, so that 2 comes before 10. A .pvd file by itself stands for the files that it lists.
 * So does a folder whose volumes have one format and names alike except for a number; files of
 * no format in it are ignored.
 *
 * *count is 0 when the path is no series, but one volume for cw_volume_read(). This holds for a
 * pattern of slices (DICOM images, TIFF files of one page, PNG, BMP), for a pattern with a layout (raw),
 * and for any other path that is not a pattern.
 *
 * paths       path_count of them
 * path_count  1 or more
 * files       set to an array of *count, to be freed with cw_steps_free()
 * Returns     CW_ERR_ARGUMENT  no path; several paths, and one is a slice, or there is a layout
 *             CW_ERR_IO        a pattern among several paths that nothing matches; CW_ERR_LIMIT;
 *                              CW_ERR_NO_MEMORY; as cw_pvd_read()
 *             CW_ERR_FORMAT    a .pvd file of meshes */
CW_NODISCARD CW_API cw_status cw_steps_list(const char *const *paths, size_t path_count,
                                            const cw_read_desc *desc, char ***files,
                                            size_t *count, cw_error *err);

/* Frees a list of files. Harmless on NULL. */
CW_API void cw_steps_free(char **files, size_t count);

/* A named array of values in a file, or a grid of OpenVDB. */
typedef struct cw_array {
    char name[64];     /* for cw_read_desc.array */
    char type[32];     /* as the file calls it: "Float32", "unsigned_char" */
    size_t components; /* values per sample or cell */
    bool of_cells;     /* one value for each cell; else for each sample */
    bool is_read;      /* cw_volume_read() can read it by its name */
    bool is_default;   /* the array that is read when none is named */
} cw_array;

/* Lists the arrays of a file of VTK or a group of Zarr or N5, the quantities of PLOT3D or the grids of
 * OpenVDB. Files of other formats, folders and patterns have none. If an array at points and one at cells have
 * the same name, the one at points is read.
 *
 * arrays   set to *count of them, to be freed with cw_arrays_free(); NULL when there are none
 * Returns  as cw_volume_read() for a header */
CW_NODISCARD CW_API cw_status cw_arrays_list(const char *path, const cw_read_desc *desc,
                                             cw_array **arrays, size_t *count, cw_error *err);

/* Frees a list of arrays. Harmless on NULL. */
CW_API void cw_arrays_free(cw_array *arrays);

/* One of the sizes in which a file holds its volume. */
typedef struct cw_level {
    char name[64];   /* path of its array in the store */
    char axes[64];   /* names of all dimensions, as they are stored: "t c z y x" */
    cw_volume shape; /* as it would be read, without voxels */
} cw_level;

/* Lists the levels of an image of OME-Zarr, N5 or Neuroglancer, the finest first. Files of other formats have none.
 *
 * levels   set to *count of them, to be freed with cw_levels_free(), or to NULL
 * Returns  as cw_volume_read() for a header */
CW_NODISCARD CW_API cw_status cw_levels_list(const char *path, const cw_read_desc *desc,
                                             cw_level **levels, size_t *count, cw_error *err);

/* Frees a list of levels. Harmless on NULL. */
CW_API void cw_levels_free(cw_level *levels);

/* A series of images in a folder of DICOM files. */
typedef struct cw_series {
    char label[32];    /* value for cw_read_desc.series: its number, and .1, .2 ... when images
                          of several sizes, directions or stacks have that number */
    char modality[20]; /* "CT"; may be empty */
    size_t images;     /* number of images */
    cw_volume shape;   /* as it would be read, without voxels; with a status other than CW_OK
                            only type and dim, which then counts the images */
    double tilt_degrees; /* of the row of slices against their normal */
    cw_status status;    /* result of reading it so: CW_OK, CW_ERR_UNSAFE, ... */
    char finding[512];   /* the uneven, missing or wrong part; empty: nothing */
} cw_series;

/* Lists the series in a folder, or in a file's folder. A path without DICOM images has none.
 * Damaged files are noted; a series that such a file may belong to has its error as status.
 * Neither names nor dates of patients are read.
 *
 * series   an array of *count, to be freed with cw_series_free(); NULL when there is none
 * Returns  CW_ERR_UNSUPPORTED when the build has no DICOM; as cw_volume_read() */
CW_NODISCARD CW_API cw_status cw_series_list(const char *path, const cw_read_desc *desc,
                                             cw_series **series, size_t *count, cw_error *err);

/* Frees a list of series. Harmless on NULL. */
CW_API void cw_series_free(cw_series *series);

/* Reads the names and colours of labels from a file: a colour table of FreeSurfer or 3D Slicer,
 * descriptions of ITK-SNAP, the CSV of 3D Slicer, the TSV of BIDS, JSON of niivue and nnU-Net, XML with a
 * LabelTable as of Connectome Workbench, the image-label of OME-Zarr, or plain lines such as
 * "5 liver" or "5;LIV;liver". The content decides which; the extension counts only where the
 * content is of none. Where A of a number, a name and R G B A may be opacity or transparency,
 * the majority is taken as opaque: 255 as of 3D Slicer, or 0 as of FreeSurfer.
 *
 * table    zeroed or filled; freed first, filled on success, else emptied. 0 is in it if the
 *          file names it; it is the background. Of a value that is there twice the last one
 *          stays.
 * format   set to a static name such as "freesurfer"; may be NULL
 * Returns  CW_ERR_IO      missing, not a regular file, empty, unreadable
 *          CW_ERR_FORMAT  no such table; a line and its field are wrong; OME-Zarr with a value
 *                         twice
 *          CW_ERR_UNSAFE  an XML document type
 *          CW_ERR_LIMIT   more than 64 MiB, or 16 MiB of JSON; CW_ERR_NO_MEMORY
 * Cost     time in proportion to n log n labels */
CW_NODISCARD CW_API cw_status cw_label_table_read(const char *path, cw_label_table *table,
                                                  const char **format, cw_error *err);

/* Finds a table of labels beside a volume: a file of the same stem with the extension .ctbl,
 * .ctab, .label, .txt, .csv, .tsv or .json, or with "_semicolon.txt" or "_dseg.tsv" behind the
 * stem. Beside a.nii.gz the stems are "a.nii" and "a". Files with other content, links and
 * unreadable files are passed over.
 * volume_path  path of the volume
 * table_path   set to the path for cw_label_table_read(), or to NULL if there is none; free it
 *              with free()
 * Returns      CW_ERR_NO_MEMORY
 * Cost         each such file is read, .txt and .json as a whole */
CW_NODISCARD CW_API cw_status cw_label_table_beside(const char *volume_path, char **table_path,
                                                    cw_error *err);

/* Parses a layout written as on the command line, for example
 * "dims=512x512x300,type=u16le,offset=62,spacing=0.5x0.5x1mm,components=1,steps=1".
 * Type is one of the eight, i64, u64 or f16, with an optional le or be; le when left out. Names of C,
 * NRRD and NumPy are known, too: uint8, int16, unsigned short, float, u1, <i2, >f4.
 * text     as above
 * layout   filled on success
 * Returns  CW_ERR_ARGUMENT naming the key that is wrong. */
CW_NODISCARD CW_API cw_status cw_raw_layout_parse(const char *text, cw_raw_layout *layout,
                                                  cw_error *err);

/* Options of reading a mesh. Zero-initialise the struct; a zero field means the default named
 * beside it. */
typedef struct cw_mesh_read_desc {
    uint32_t version;       /* 0: the first version of this struct */
    const char *reader;     /* a name of cw_formats(); default: by content, then extension */
    bool allow_external;    /* buffers outside the .gltf file's folder; default: refused */
    uint64_t max_triangles; /* default 2^32 - 1 */
    uint64_t max_bytes;     /* of the arrays that a mesh takes during reading; default: no
                               limit */
    bool no_sandbox;        /* run libraries in this process, not in a sandboxed one */
    double timeout_s;       /* for a library; default 60 */
    bool truncated; /* take the whole facets of an STL that breaks off; default: refused */
    cw_claim claim; /* on the file's coordinates; default: as the file states, else LPS
                               mm */
    cw_progress progress;         /* default: none */
    const cw_stored_file *stored; /* the bytes to read, in place of those at the path, which may
                                     then be NULL; default: none */
} cw_mesh_read_desc;

/* Facts that a mesh file states, and the reader's decisions. */
typedef struct cw_mesh_file {
    const char *format; /* the reader's name (static) */
    unsigned known;     /* cw_known flags; unknown properties were taken as LPS millimetres */
    cw_axes axes;       /* the file's own axes; zeroed for glTF and where not known */
    bool local;         /* coordinates were relative to an origin that the file names */
    size_t parts;       /* number of merged parts: objects of OBJ, items of 3MF, placed meshes
                           of glTF; else 1 */
    size_t polygons;    /* faces of more than three corners, cut into triangles */
    size_t skipped;     /* points, lines and faces of fewer than three corners: left out */
    size_t levels;      /* maximum number of coarser levels of detail of a mesh (MSFT_lod of
                           glTF): no part of the scene, left out */
    size_t hidden;      /* meshes of glTF hidden by a scale of 0, such as those that an
                           animation shows later: left out */
    size_t supports, support_triangles; /* placed objects of 3MF for support: left out */
    size_t others, other_triangles;     /* placed objects of 3MF of type "other": left out */
    bool truncated;                     /* an STL breaks off, and what came before was taken */
    size_t expected_triangles; /* of that STL by its header; 0: a text, which does not say */
    char fault[160]; /* of glTF: a value beyond its range, or bounds that are not those of the
                        positions, neither of which changes the mesh; "": none found */
    size_t crossing; /* of the polygons: those that cross themselves, whose triangles overlap */

    /* Of any format: features that the mesh has no place for, such as "textures, texture coordinates"; "": none
     * that are known. */
    char left_out[128];

    /* An STL whose header counts expected_triangles, and whose size tells another number, which was
     * taken. */
    bool miscounted;
    uint64_t attribute_bytes; /* behind the facets of an STL, as they state: left out */

    /* Of glTF: features that viewers apply and this reader does not, such as "colours of morph
     * targets"; "": none. */
    char not_applied[160];

    /* Of 3MF: triangles of modifiers, blockers of supports and negative volumes, as slicers call
     * them: left out. */
    size_t modifier_triangles;

    size_t invisible;          /* meshes of glTF that KHR_node_visibility hides: left out */
    char invisible_names[160]; /* of those nodes; "..." where there is no room for all */

    size_t pieces; /* of VTK's files in pieces: those that were joined; 0: there is one */
    size_t merged_vertices; /* vertices on seams of pieces that are one with others */
    size_t
        marked_cells; /* cells of VTK left out, as another piece has them or they are hidden */

    /* Of GIfTI and FreeSurfer: the file's own transform to the frame of the scanner, which was applied,
     * such as "c_ras: a shift by (1, 2, 3) mm, RAS"; "": none. */
    char placed[128];
} cw_mesh_file;

/* Reads a mesh: all parts of the file, merged, in LPS millimetres.
 *
 * Vertices keep their numbers, also those that no triangle names. Positions keep their bits
 * where the file has single precision. STL shares nothing: its corners at equal coordinates
 * become one vertex, and its facet normals are ignored. The words behind its facets are colours of faces, if
 * they are those of VisCAM and SolidView (bit 15 is set, or all are 0), or the header has a colour of
 * Materialise Magics. Triangles without area are kept. A
 * polygon becomes a fan around its first corner where that is right, as when it is convex; else it
 * is cut into triangles by its ears, as seen along the axis along which it is largest.
 * Normals are kept when every vertex has one that is finite, and OBJ does not name two for it.
 * A file without triangles gives a mesh without triangles, and CW_OK.
 *
 * The origin is the one that the file names, if this library wrote it. Otherwise it is 0, with
 * one exception. If places are more than ten times the mesh's size from zero, and more exact
 * than single precision, it is the middle of the mesh's box.
 *
 * glTF is in metres, +Y up: its scene is turned to LPS millimetres, (x, y, z) to (1000 x, -1000
 * z, 1000 y). Every placement of a mesh by a node is read, and every instance of
 * EXT_mesh_gpu_instancing. Morph targets are applied by the weights of the node, else of the mesh, and
 * skins at rest: their joints place the vertices, not the node. A mirrored mesh has its winding
 * reversed, so that triangles stay counter-clockwise from outside. Animations are
 * ignored. A node with a scale of 0 along all axes is hidden, as are one that
 * KHR_node_visibility hides and its children, and left out.
 *
 * Files of VTK in pieces (.pvtp) are joined: their seams are closed where vertices are at the same place to
 * the bit. GIfTI and FreeSurfer's surfaces are in RAS millimetres; the transform that they state to the
 * frame of the scanner is applied.
 *
 * Texture coordinates of OBJ and glTF (the first set, moved by KHR_texture_transform) are those of corners:
 * CW_TEXTURE_COORDINATES. Vertices of glTF that differ in them alone were split at a seam, and become one. Pictures
 * are read with parts (cw_parts_read()).
 *
 * From 3MF all objects of the build are placed, with components, in the unit that the file
 * names. A mirrored object also has its winding reversed.
 *
 * Colours of materials (glTF, 3MF, .mtl beside OBJ) become those of vertices where no vertex gets
 * two; else, and where PLY, OFF, VTP or STL colour faces, they are the attribute CW_FACE_COLORS. In glTF
 * they are multiplied with COLOR_0; a base colour of white, or of 0.8 of it, counts as none. Labels that
 * our glTF states are those of vertices, if each part has one.
 *
 * mesh     filled on success, emptied on failure; free it with cw_mesh_free()
 * file     filled on success; may be NULL
 * Returns  CW_ERR_IO           missing, empty, not a regular file, unreadable
 *          CW_ERR_FORMAT       not understood, damaged or truncated; an index beyond the
 *                              vertices, a coordinate that is not finite; names the place
 *          CW_ERR_UNSAFE       a .gltf file names a buffer outside its own folder, a .3mf file
 *                              a model outside itself; an XML document type
 *          CW_ERR_UNSUPPORTED  glTF or LZ4 is not in this build, or the file needs an extension
 *                              of glTF or 3MF that is not read
 *          CW_ERR_BACKEND      a library crashed on the file, or took too long
 *          CW_ERR_LIMIT        more triangles, vertices or bytes than allowed; glTF or 3MF that
 *                              draws its meshes so often that 2^26 triangles and the bytes of
 *                              its files are exceeded, 3MF whose text is 64 MiB and 100 times
 *                              its archive, unless max_triangles is stated
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 *          CW_ERR_ARGUMENT     no such reader; a claim that the file contradicts
 * Cost     one pass over the file; 24 bytes a vertex and 12 a triangle while it is read */
CW_NODISCARD CW_API cw_status cw_mesh_read(const char *path, const cw_mesh_read_desc *desc,
                                           cw_mesh *mesh, cw_mesh_file *file, cw_error *err);

/* Reads a mesh from bytes in memory or from a function of the caller, as cw_volume_read_memory() does.
 * Buffers of glTF in other files and pieces of VTK are CW_ERR_UNSUPPORTED, named by the message. Pictures
 * of glTF in other files and materials of OBJ (.mtl) are left out (cw_mesh_file.left_out), as where such a
 * file is missing. For parts see cw_mesh_read_desc.stored and cw_parts_read().
 *
 * source   borrowed until the call returns
 * desc     as for cw_mesh_read(); stored is not used
 * mesh     filled on success, emptied on failure; free it with cw_mesh_free()
 * file     filled on success; may be NULL
 * Returns  as cw_stored_file_open() and cw_mesh_read()
 * Cost     that of cw_mesh_read(), and one copy of the bytes meanwhile */
CW_NODISCARD CW_API cw_status cw_mesh_read_memory(const cw_byte_source *source,
                                                  const cw_mesh_read_desc *desc, cw_mesh *mesh,
                                                  cw_mesh_file *file, cw_error *err);

/* A picture on a surface: the bytes of its file. PNG and JPEG are known; those of others, such as WebP and
 * KTX2, are read and written as they are. */
typedef struct cw_texture {
    const uint8_t *bytes; /* borrowed; NULL: none */
    size_t size;          /* number of bytes */
} cw_texture;

/* The pictures on a surface, by the texture coordinates of its mesh. */
typedef struct cw_textures {
    uint32_t version;  /* 0: the first version of this struct */
    cw_texture normal; /* a normal map in tangent space, see cw_bake_normals() */

    /* The members that follow are those of glTF's materials. */
    cw_texture color;              /* base colour, sRGB; its alpha is opacity */
    cw_texture metallic_roughness; /* green: roughness; blue: metalness */
    cw_texture occlusion;          /* red: how much light from around arrives */
    cw_texture emissive;           /* light of its own, sRGB */
    bool
        has_factors; /* the next five count; default: white, not metallic, roughness 0.8, no light */
    float color_factor[4];                  /* linear; multiplied with the colour */
    float metallic_factor;                  /* multiplied with blue of metallic_roughness */
    float roughness_factor;                 /* multiplied with its green */
    float emissive_factor[3];               /* linear; multiplied with emissive */
    float normal_scale, occlusion_strength; /* 0: 1 */
    bool repeats; /* the texture goes on beyond 0 and 1; default: it ends there */
} cw_textures;

/* Decodes a picture on a surface. PNG of any kind but palettes of colours becomes red, green, blue and
 * opacity of 8 bits, values as they are.
 * texture  borrowed
 * desc     borrowed: max_bytes, no_sandbox, timeout_s and progress count; NULL means all defaults
 * image    allocated and filled on success; free it with cw_image_free()
 * Returns  CW_ERR_UNSUPPORTED  JPEG and other kinds; PNG is not in this build
 *          CW_ERR_FORMAT       damaged, or larger than its bytes can hold
 *          CW_ERR_LIMIT        more than 16384 texels along a side
 *          CW_ERR_ARGUMENT     no bytes
 *          CW_ERR_BACKEND, CW_ERR_CANCELLED, CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_texture_decode(const cw_texture *texture,
                                                const cw_mesh_read_desc *desc, cw_image *image,
                                                cw_error *err);

/* A named mesh, one of several in a file. */
typedef struct cw_part {
    const cw_mesh *mesh;   /* borrowed */
    const char *name;      /* default: the file's name and a number */
    const cw_label *label; /* the label that it is the surface of, borrowed; default: none */
    size_t level; /* level of detail: level n + 1 is a coarser form of level n, right after it,
                     for viewers to show where the part appears small; default: 0, a part by
                     itself */
    double max_error_mm, rms_error_mm; /* for a level: its distance from the true surface;
                                          default: 0, not stated */
    double time_s; /* animated: the time at which it appears, instead of the part before it */
    const cw_mesh_spool
        *spool; /* borrowed: mesh is cw_mesh_spool_frame() of it; default: none. That of a team
                   (cw_mesh_spool_share) is written by all its processes together: PLY, STL and
                   GLB in binary by each at its place, other formats by rank 0 */
    const cw_textures *textures; /* borrowed; parts may share one; default: none */
} cw_part;

/* Reads the parts of a file, each as a mesh. Parts are the objects of OBJ, or its groups if it
 * has no objects; the solids of an STL text; the build items of 3MF; the nodes of glTF; the blocks of VTM. Groups
 * that share vertices are one part, so that none is cut from its neighbours. If there are
 * several parts, vertices that no triangle names are left out. Other formats, and files without
 * parts, give one part.
 *
 * parts    set to an array of *count, which owns the meshes: free it with cw_parts_free().
 *          Names are NULL where the file has none; bytes other than printable UTF-8 become '_'.
 *          Labels are those that our glTF states, with their colour and codes; else NULL.
 *          Parts whose materials have pictures have textures: an object with several such materials
 *          is a part for each
 * file     as in cw_mesh_read()
 * Returns  as cw_mesh_read()
 * Cost     that of cw_mesh_read() and, if there are several, as much memory once more */
CW_NODISCARD CW_API cw_status cw_parts_read(const char *path, const cw_mesh_read_desc *desc,
                                            cw_part **parts, size_t *count, cw_mesh_file *file,
                                            cw_error *err);

/* Frees parts and their meshes. Harmless on NULL.
 * parts  count of them, or NULL */
CW_API void cw_parts_free(cw_part *parts, size_t count);

/* The storage of meshes in glTF. Each but the first needs an extension of glTF that viewers
 * must know. The positions of all parts are written on one common grid. */
typedef enum cw_compression {
    CW_COMPRESS_NONE,
    CW_COMPRESS_QUANTIZE, /* 16 bits a coordinate: KHR_mesh_quantization */
    CW_COMPRESS_DRACO,    /* KHR_draco_mesh_compression */
    CW_COMPRESS_MESHOPT /* EXT_meshopt_compression: 16 bits are quantised, up to 24 filtered */
} cw_compression;

/* The results of compression, measured on the decoded data. */
typedef struct cw_compressed {
    int bits;                  /* bits of a coordinate; 0: positions are unchanged */
    double step_mm;            /* step of the grid */
    double error_mm;           /* the largest move of a vertex */
    double normal_degrees;     /* the largest turn of a normal */
    size_t merged;             /* vertices that fell onto another: only with bits stated */
    size_t flat;               /* triangles that lost their area: only with bits stated */
    size_t dropped;            /* triangles with a vertex twice, which Draco cannot store;
                                  neuroglancer: that rounding left so, of the finest level */
    size_t fragments;          /* meshes in the nodes of an octree: neuroglancer alone */
    uint64_t bytes;            /* of the arrays in the file */
    double encode_s, decode_s; /* times to encode, and to check the decoded data */
    size_t
        settled; /* positions that are not the nearest of the grid: rounding would have put points
                       onto each other, or a triangle into a line */
} cw_compressed;

/* A line on the origin of a mesh, for the file's own record. */
typedef struct cw_provenance {
    const char *key, *value; /* UTF-8 */
} cw_provenance;

/* Options of writing a volume or mesh. Zero-initialise the struct. */
typedef struct cw_write_desc {
    uint32_t version;           /* 0: the first version of this struct */
    const char *format;         /* a name of cw_formats(); default: by the path's extension */
    const char *name;           /* of the object inside the file; default: the path's stem */
    bool no_clobber;            /* fail when the path exists; default: replace it */
    bool local;                 /* mesh: relative to its origin; default: in the world */
    cw_axes axes;               /* mesh: default LPS millimetres; glTF is in metres, +Y up */
    bool text;                  /* STL, PLY: numbers as text; default: binary */
    cw_compression compression; /* of glTF; CW_ERR_ARGUMENT for other formats */
    double tolerance_mm; /* for glTF: the largest move of a vertex; for neuroglancer: of a point
                            of the finest level; default: 1/20,000 of the diagonal */
    int bits;            /* for glTF: bits of a coordinate, 1 to 16 (quantize), 24 (meshopt) or
                            30 (Draco, which takes up to 2^bits x 4 bytes for it), whatever the
                            loss; default: as many as the tolerance and the shape require, and
                            floats where 24 are too few (meshopt, Draco). For neuroglancer 10
                            or 16 in a node of an octree, which is as fine as the tolerance
                            requires; default: 16 */
    int level;           /* for Draco: 1 (fast) to 10 (small); default 7 */
    cw_compressed *compressed; /* filled in; default: none */
    bool animated; /* for glTF: parts are shown one after another, each at its time_s; default:
                      all of them at once; CW_ERR_ARGUMENT for other formats */
    const uint32_t *sides; /* for VTP and PLY, with one mesh: triangle_count x 2, the labels
                              that each triangle separates: the one behind it, then the one
                              that it faces; CW_ERR_ARGUMENT for other formats; default: none */
    const cw_provenance *provenance; /* in the extras of a glTF file; default: none */
    size_t provenance_count;         /* number of lines */
    cw_progress progress;            /* default: none */
    const cw_label_table
        *labels; /* with sides, the numbers, names and colours of those. volume: names and
                    colours of its labels, for a format whose keeps have
                                     CW_KEEPS_LABELS: NRRD (as segments of 3D Slicer) and NIfTI (as the
                                     LabelTable of Connectome Workbench); others leave them out; default: none */
    const cw_byte_sink
        *sink; /* receiver of the file's bytes, in place of the path, of which the
                                 extension and the name alone count; NULL is then allowed for
                                 it. CW_ERR_UNSUPPORTED for what takes more files than one: the
                                 folders of neuroglancer, and OBJ with materials or pictures;
                                 default: none */
} cw_write_desc;

/* Writes a volume to a file beside the path, flushes it, then renames it. So the path holds
 * either the old file or the whole new one. The path's extension decides the format (.nrrd,
 * .nii, .nii.gz, .mha; .mhd is not written).
 * Returns  CW_ERR_ARGUMENT     no writer of that name or extension; local, text or axes, which
 *                              are for meshes
 *          CW_ERR_OUTPUT       folder missing, disk full, path exists and no_clobber
 *          CW_ERR_UNSUPPORTED  the format is not in this build; the grid is rectilinear
 *          CW_ERR_CANCELLED */
CW_NODISCARD CW_API cw_status cw_volume_write(const char *path, const cw_volume *volume,
                                              const cw_write_desc *desc, cw_error *err);

/* Writes a mesh in the same way: .glb, .gltf, .stl, .ply, .obj, .off, .3mf, .vtp or .gii; or a folder
 * of the format "neuroglancer", see cw_parts_write(). glTF is written in metres, +Y up and facing +Z, by the node's transform, so vertices stay exact. They
 * stay exact in 3MF, too, whose build items hold the origin. The other formats hold world
 * coordinates (origin added), LPS millimetres: see cw_mesh_write_loss().
 *
 * The labels of both sides of triangles (sides) are the cell array "BoundaryLabels" in VTP, and
 * the properties "label_0" and "label_1" of PLY's faces.
 *
 * local leaves the origin out: coordinates are the mesh's positions, and the glTF node has no
 * translation. The file names the origin; adding it gives the coordinates of the world. PLY,
 * OBJ, OFF and VTP name it in a comment, STL in its header when it fits there, glTF in the
 * node's extras, 3MF in its metadata.
 *
 * Those comments also name unit and frame (axes); cw_mesh_read() converts them back.
 * Returns  as cw_volume_write(); CW_ERR_ARGUMENT as cw_mesh_check(), for an empty mesh, for
 *          glTF in another unit or frame than its own, for text in a format without text;
 *          CW_ERR_LIMIT when the format's own sizes are too small for the mesh. */
CW_NODISCARD CW_API cw_status cw_mesh_write(const char *path, const cw_mesh *mesh,
                                            const cw_write_desc *desc, cw_error *err);

/* Writes a mesh to memory: the bytes of the file that cw_mesh_write() makes. To hand them to a function
 * piece by piece, give cw_mesh_write() or cw_parts_write() a cw_write_desc.sink.
 *
 * name     a file name such as "mesh.stl": its extension is the format, its stem the name of the
 *          object inside. NULL: desc->format is the format
 * mesh     borrowed
 * desc     as for cw_mesh_write(); sink is not used
 * bytes    set to the file's bytes, to be freed with cw_bytes_free(); NULL on failure
 * size     set to their number
 * Returns  as cw_mesh_write(); CW_ERR_UNSUPPORTED: it takes more files than one, as OBJ with
 *          materials or pictures does
 * Cost     that of cw_mesh_write(), and the bytes twice until the call returns */
CW_NODISCARD CW_API cw_status cw_mesh_write_memory(const char *name, const cw_mesh *mesh,
                                                   const cw_write_desc *desc, uint8_t **bytes,
                                                   size_t *size, cw_error *err);

/* Writes a volume to memory: the bytes of the file that cw_volume_write() makes.
 *
 * name     a file name such as "scan.nii.gz"; NULL: desc->format is the format
 * volume   borrowed
 * desc     as for cw_volume_write(); sink is not used
 * bytes    set to the file's bytes, to be freed with cw_bytes_free(); NULL on failure
 * size     set to their number
 * Returns  as cw_volume_write()
 * Cost     that of cw_volume_write(), and the bytes twice until the call returns */
CW_NODISCARD CW_API cw_status cw_volume_write_memory(const char *name, const cw_volume *volume,
                                                     const cw_write_desc *desc, uint8_t **bytes,
                                                     size_t *size, cw_error *err);

/* Writes parts into one file. OBJ and 3MF get an object for each. In the other formats the
 * parts are joined into one mesh, with the arrays that all of them have. Parts without
 * triangles are left out. A local file has the origin of the first part.
 *
 * The label of a part colours it, or the one colour that all its vertices have: by a material in glTF,
 * by a colour group in 3MF. OBJ gets a second file for that and for colours of faces, with the path's
 * stem and the extension .mtl. Pictures of textures are files beside it, named by the stem and their use
 * (_color.jpg, _normal.png), with a number where another file has that name. In the extras of a glTF
 * node are the label's value, colour and codes. In the other formats its value and colour are
 * those of the vertices, if all parts have them.
 *
 * glTF has colours of vertices and of materials. Up to 128 colours of faces are a primitive and a
 * material each, with common vertices, and triangles are in the order of their colours. With more, and
 * compressed by Draco or meshopt, they are those of vertices, and a vertex of several colours is
 * written once for each (cw_write_loss.split_vertices). They win over colours of vertices.
 *
 * The format "neuroglancer" writes a folder of multi-resolution meshes with a segment for each
 * part, whose levels are its levels of detail. The label of a part is the segment's number;
 * without labels segments count from 1. Names and, of closed parts, volumes are segment
 * properties. An old folder is replaced if it is empty or such a mesh, and holds nothing else.
 *
 * Levels of detail are for glTF and neuroglancer. The scene of glTF holds level 0, whose node names the nodes of the
 * other levels (MSFT_lod) and the share of the screen below which each is enough. At that share
 * it has as many triangles to an area as level 0 has on all of it. Readers without the
 * extension see only level 0, and so does cw_mesh_read().
 *
 * Animated parts each have a node whose scale is animated: 1 from the part's time until that of
 * the next part, otherwise 0. The last part stays as long as the one before it. The animation
 * starts with the first part. A part without triangles shows nothing for its time. Readers that
 * play no animation, such as cw_mesh_read(), show the first part that has triangles.
 *
 * Returns as cw_mesh_write(); CW_ERR_ARGUMENT for levels that do not follow one another, have
 * no triangles, or are for another format; for labels of neuroglancer that are 0, twice there, or
 * of some parts alone; CW_ERR_CHECK for a part of neuroglancer that is smaller than its steps;
 * CW_ERR_ARGUMENT for an animation of fewer than two parts, of levels,
 * or of times that do not ascend in single precision */
CW_NODISCARD CW_API cw_status cw_parts_write(const char *path, const cw_part *parts,
                                             size_t count, const cw_write_desc *desc,
                                             cw_error *err);

/* The last word on a file that is about to appear at its path. */
typedef struct cw_write_consent {
    cw_status (*ask)(void *user, cw_error *err); /* CW_OK: the file may appear */
    void *user;                                  /* for ask */
} cw_write_consent;

/* Writes as cw_parts_write(), and asks for consent when all bytes are on the disk. Without it
 * the path keeps its old file. So a mesh can be checked by one thread while another one writes
 * it: ask waits for the verdict. It is called once, on the calling thread; a failure before
 * calls it never. A team is asked before it writes.
 *
 * consent  borrowed
 * Returns  as cw_parts_write(), or as consent->ask() */
CW_NODISCARD CW_API cw_status cw_parts_write_with_consent(const char *path,
                                                          const cw_part *parts, size_t count,
                                                          const cw_write_desc *desc,
                                                          const cw_write_consent *consent,
                                                          cw_error *err);

/* The parts of a mesh that a file will not hold, above all the digits of world coordinates that
 * single precision loses. */
typedef struct cw_write_loss {
    double step_mm;         /* between neighbouring numbers, at the farthest coordinate */
    size_t merged_vertices; /* vertices that fall onto another one, different before */
    size_t flat_triangles;  /* triangles that had an area and lose it */
    unsigned dropped;       /* attributes that the meshes have and the file will not: cw_keeps
                               flags */
    char attributes[256];   /* names of those of cw_mesh.attributes, such as "uv, thickness" */
    size_t split_vertices;  /* vertices that glTF has more, because each has one colour there */
    size_t rounded_colors;  /* faces whose colours STL rounds to 5 bits a channel */
} cw_write_loss;

/* Measures the loss for a reader with single precision of a file by cw_mesh_write() or
 * cw_parts_write(). glTF and local files lose no vertex or triangle: they hold the positions as
 * they are. STL and PLY lose digits in the file. OBJ and OFF hold every digit, but most of
 * their readers do not. Vertices of different parts are not compared. CW_KEEPS_PLACES is
 * dropped where some vertex or triangle is lost.
 *
 * Returns  CW_ERR_ARGUMENT  no such writer, or as cw_mesh_check(); CW_ERR_NO_MEMORY
 * Cost     time in proportion to the triangles, and 28 bytes a vertex at most */
CW_NODISCARD CW_API cw_status cw_mesh_write_loss(const char *path, const cw_mesh *mesh,
                                                 const cw_write_desc *desc, cw_write_loss *loss,
                                                 cw_error *err);
CW_NODISCARD CW_API cw_status cw_parts_write_loss(const char *path, const cw_part *parts,
                                                  size_t count, const cw_write_desc *desc,
                                                  cw_write_loss *loss, cw_error *err);

/* Checks if cw_mesh_write() could write to a path, as far as can be known before there is a
 * mesh. The writer and its library must be present, the folder must exist and be writable, and
 * nothing may be in the way. Returns the same errors. */
CW_NODISCARD CW_API cw_status cw_mesh_write_check(const char *path, const cw_write_desc *desc,
                                                  cw_error *err);

/* Orders the triangles of a mesh for the caches of graphics processors. Orders its vertices as
 * the triangles name them.
 *
 * mesh     in place; unchanged on failure
 * Returns  CW_ERR_UNSUPPORTED  this build has no meshoptimizer; CW_ERR_ARGUMENT as
 *                              cw_mesh_check(); CW_ERR_NO_MEMORY
 * Source   meshoptimizer: optimizeVertexCache, optimizeVertexFetch */
CW_NODISCARD CW_API cw_status cw_mesh_optimize(cw_mesh *mesh, cw_error *err);

/* A file of a time series, with its time. */
typedef struct cw_pvd_entry {
    const char *path; /* as this program names it */
    double time;      /* in any unit */
} cw_pvd_entry;

/* Reads a .pvd file, in the order of times; an entry without a time has time 0. Entries name
 * existing files, by paths that are valid from the current folder. Only allow_external of desc
 * counts; without it the files must lie below the .pvd's folder.
 * entries  set to *count of them, to be freed with cw_pvd_free()
 * Returns  CW_ERR_IO           the .pvd or one of its files is missing, or no regular file
 *          CW_ERR_FORMAT       no list, an empty one, a time that is not a number
 *          CW_ERR_UNSAFE       a file outside the .pvd's folder; an XML document type
 *          CW_ERR_UNSUPPORTED  several files of one time; CW_ERR_LIMIT; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_pvd_read(const char *path, const cw_read_desc *desc,
                                          cw_pvd_entry **entries, size_t *count, cw_error *err);

/* Frees a list of entries. Harmless on NULL. */
CW_API void cw_pvd_free(cw_pvd_entry *entries, size_t count);

/* Returns true if the content of a file is that of a .pvd file. */
CW_API bool cw_pvd_is(const char *path);

/* Writes a .pvd file, which ParaView opens as a time series. It lists files, such as .vtp, with
 * the time of each, by names relative to its own folder. Files of one time in a row are parts
 * of it. The files need not exist. Only no_clobber of desc counts.
 * entries  count of them, borrowed
 * Returns  CW_ERR_ARGUMENT  no entries, a time that is not finite, a file that cannot be named
 *                           from the .pvd's folder because one of both paths goes up by ".."
 *          CW_ERR_OUTPUT as cw_mesh_write() */
CW_NODISCARD CW_API cw_status cw_pvd_write(const char *path, const cw_pvd_entry *entries,
                                           size_t count, const cw_write_desc *desc,
                                           cw_error *err);

/* The properties of a mesh that a file of a format holds. Of the formats of volumes, those with
 * CW_KEEPS_LABELS hold cw_write_desc.labels. */
typedef enum cw_keeps {
    CW_KEEPS_SHARING = 1, /* vertices that triangles share */
    CW_KEEPS_PLACES =
        2, /* positions to the bit at any distance from zero: the origin is separate */
    CW_KEEPS_NORMALS = 4,
    CW_KEEPS_COLORS = 8,
    CW_KEEPS_SCALARS = 16,
    CW_KEEPS_LABELS = 32,
    CW_KEEPS_AFFINE = 64,
    CW_KEEPS_PARTS = 128, /* several meshes, with names */
    CW_KEEPS_ATTRIBUTES =
        256, /* those of cw_mesh.attributes but the three below: no format so far */
    CW_KEEPS_FACE_COLORS = 512, /* CW_FACE_COLORS */
    CW_KEEPS_OPACITY = 1024,    /* of vertices, beside their colours */
    CW_KEEPS_TEXTURE = 2048,    /* CW_TEXTURE_COORDINATES; glTF splits vertices at seams */
    CW_KEEPS_PICTURES = 4096,   /* cw_part.textures: colour, normal and emissive pictures */
    CW_KEEPS_MATERIALS = 8192,  /* the other pictures, and factors */
    CW_KEEPS_CREASES = 16384,   /* CW_CORNER_NORMALS; glTF splits vertices at creases */
    CW_KEEPS_ALL = 32767
} cw_keeps;

/* A format that this build or another one reads or writes. */
typedef struct cw_format {
    const char *name;                                          /* "nrrd" */
    const char *extensions;                                    /* ".nrrd .nhdr" */
    const char *about;                                         /* for people */
    bool reads_volume, writes_volume, reads_mesh, writes_mesh; /* in any build */
    bool in_this_build; /* false: calls that need it return CW_ERR_UNSUPPORTED */
    const char *reason; /* why it is not in this build; "" when it is */
    const char *lost;   /* information that writing drops; "" for nothing */
    unsigned keeps;     /* parts of a written mesh that the file keeps: cw_keeps flags */
} cw_format;

/* Returns the format in which a mesh is written: the one of that name or, if name is NULL, the
 * one of the path's extension. Returns NULL when there is none. */
CW_API const cw_format *cw_mesh_format(const char *path, const char *name);

/* Returns the format in which a volume is written, in the same way. */
CW_API const cw_format *cw_volume_format(const char *path, const char *name);

/* Returns all formats, in_this_build or not; *count rows, static. */
CW_API const cw_format *cw_formats(size_t *count);

#ifdef __cplusplus
}
#endif

#endif
