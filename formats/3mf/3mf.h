/* The state of reading a 3MF package: the content of its models, and the placement of their
 * objects. */
#ifndef FORMATS_3MF_3MF_H
#define FORMATS_3MF_3MF_H

#include "formats/bytes/zip_read.h"
#include "formats/mesh/mesh_reader.h"
#include "formats/text/xml.h"

typedef enum cwi_3mf_type {
    CWI_3MF_SHAPE,   /* model, surface: these are read */
    CWI_3MF_SUPPORT, /* support, solidsupport */
    CWI_3MF_OTHER
} cwi_3mf_type;

/* An object: a mesh, given by ranges of points and triangles among all, or a range of
 * components. */
typedef struct cwi_3mf_object {
    size_t first_point, end_point, first_triangle, end_triangle;
    size_t first_component, end_component;
    size_t name; /* start of its name among the names */
    cwi_3mf_type type;
} cwi_3mf_object;

/* A placed object of a model: a component of another one, or an item of the build. */
typedef struct cwi_3mf_component {
    uint32_t model, id;
    double transform[12]; /* an affine */
} cwi_3mf_component;

/* A resource of a model: an object, or a group of colours. */
typedef struct cwi_3mf_resource {
    uint64_t key; /* of model and id; 0: none */
    bool is_group;
    size_t object;     /* ... its number */
    size_t first, end; /* among the colours */
} cwi_3mf_resource;

/* Triangles of an object that slicers say are no part of the print, counted in the object. */
typedef struct cwi_3mf_modifier {
    uint32_t object, first, last;
} cwi_3mf_modifier;

/* Maximums, small enough that even ids made to collide are found quickly. */
enum { CWI_3MF_MODELS = 1024, CWI_3MF_RESOURCES = 1 << 16 };

typedef struct cwi_3mf {
    cwi_mesh_input *in;
    cw_mesh *mesh;
    cw_mesh_file *metadata;
    cwi_unzip zip;

    /* The models: the package's own, and those that its relationships name. */
    char *models[CWI_3MF_MODELS];
    bool is_wanted[CWI_3MF_MODELS];
    size_t model_count;

    /* The models' content. Triangles count points from the first of all. */
    cwi_mesh_build build;
    uint32_t *point_colors; /* index of a colour, or cwi_3mf_none; for the first color_count
                               points */
    size_t point_color_capacity, point_color_count;
    bool mixed_colors; /* some point has two colours: then triangles keep theirs */
    uint32_t
        *face_colors; /* index of a colour of each triangle, at its first corner; as above */
    size_t face_color_capacity, face_color_count;
    bool is_graded;   /* some triangle has several colours */
    uint32_t *colors; /* 0xRRGGBBAA */
    size_t color_count, color_capacity;
    cwi_3mf_object *objects;
    size_t object_count, object_capacity;
    cwi_3mf_component *components;
    size_t component_count, component_capacity;
    cwi_3mf_component *items;
    size_t item_count, item_capacity;
    bool has_build;
    char *names; /* each ends with a zero */
    size_t name_bytes, name_capacity;
    cwi_3mf_resource *resources; /* a hash table */
    size_t resource_count, slots;
    cwi_3mf_modifier *modifiers;
    size_t modifier_count, modifier_capacity;
    uint64_t text_left; /* bytes of XML that may still be read */
} cwi_3mf;

extern const uint32_t cwi_3mf_none;

/* Reads a model of the package, by its number, with all that is in it.
 * Returns CW_ERR_FORMAT, CW_ERR_UNSAFE (a document type), CW_ERR_UNSUPPORTED (it needs an
 * extension that is not read), CW_ERR_LIMIT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_3mf_read_model(cwi_3mf *m, size_t model, cw_error *err);

/* Reads which volumes of objects are no parts of the print, if a slicer has said so. Returns the same
 * errors. */
CW_NODISCARD cw_status cwi_3mf_read_slicer(cwi_3mf *m, cw_error *err);

/* Returns true if a triangle of an object, counted in it, is no part of the print. */
bool cwi_3mf_is_modifier(const cwi_3mf *m, uint32_t object, size_t triangle);

/* Copies the objects, placed as the build states, into the mesh. Returns the same errors. */
CW_NODISCARD cw_status cwi_3mf_place(cwi_3mf *m, cw_error *err);

/* Reads an entry of the package as XML. Returns CW_ERR_LIMIT for more text than may be read. */
CW_NODISCARD cw_status cwi_3mf_read_xml(cwi_3mf *m, const char *path,
                                        const cwi_xml_rules *rules, void *user, cw_error *err);

/* Finds the resource of a model and id; returns NULL when there is none. */
cwi_3mf_resource *cwi_3mf_find(const cwi_3mf *m, size_t model, uint32_t id);

#endif
