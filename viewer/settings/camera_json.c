/* Reads and writes cameras as JSON, by the schema "cubewright-camera-1". */
#include <cubewright/camera.h>

#include "core/base/status.h"
#include "core/base/text.h"
#include "core/files/atomic_file.h"
#include "viewer/settings/json.h"

#include <stdio.h>
#include <string.h>

static const char schema[] = "cubewright-camera-1";

static cw_status take_vector(const json_t *root, const char *key, double v[3], cw_error *err)
{
    const json_t *list = json_object_get(root, key);
    bool good = json_is_array(list) && json_array_size(list) == 3;
    for (size_t a = 0; good && a < 3; a++) {
        good = json_is_number(json_array_get(list, a));
        v[a] = json_number_value(json_array_get(list, a));
    }
    return good ? CW_OK
                : cwi_fail(err, CW_ERR_FORMAT, "'%s': [x, y, z] in mm was expected", key);
}

static cw_status take_angle(const json_t *root, cw_camera *c, cw_error *err)
{
    const bool fov = json_object_get(root, "fov_deg"),
               height = json_object_get(root, "height_mm");
    cw_status st = cwi_json_number(root, "fov_deg", &c->fov_deg, err);
    if (st == CW_OK)
        st = cwi_json_number(root, "height_mm", &c->height_mm, err);
    if (st == CW_OK && fov == height)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "either 'fov_deg' (perspective) or 'height_mm' (orthographic) was "
                        "expected");
    if (st == CW_OK && fov && !(c->fov_deg > 0))
        return cwi_fail(err, CW_ERR_FORMAT, "'fov_deg' is %g: above 0 was expected",
                        c->fov_deg);
    return st;
}

static cw_status parse_camera(const char *bytes, size_t size, void *out, cw_error *err)
{
    static const char *const keys[] = {"eye", "target", "up", "fov_deg", "height_mm", NULL};
    cw_camera c = {0};
    double axes[3][3];
    json_t *root;
    cw_status st = cwi_json_object(bytes, size, schema, keys, &root, err);
    if (st == CW_OK)
        st = take_vector(root, "eye", c.eye, err);
    if (st == CW_OK)
        st = take_vector(root, "target", c.target, err);
    if (st == CW_OK)
        st = take_vector(root, "up", c.up, err);
    if (st == CW_OK)
        st = take_angle(root, &c, err);
    json_decref(root);
    if (st == CW_OK && cw_camera_axes(&c, axes[0], axes[1], axes[2], err) != CW_OK) {
        st = CW_ERR_FORMAT;
        if (err)
            err->status = st;
    }
    if (st == CW_OK)
        memcpy(out, &c, sizeof c);
    return st;
}

cw_status cw_camera_read(const char *path, cw_camera *camera, cw_error *err)
{
    CWI_REQUIRE(err, path, camera);
    return cwi_json_read(path, parse_camera, camera, err);
}

cw_status cw_camera_parse(const char *text, cw_camera *camera, cw_error *err)
{
    CWI_REQUIRE(err, text, camera);
    return parse_camera(text, strlen(text), camera, err);
}

cw_status cw_camera_format(const cw_camera *camera, char text[CW_CAMERA_TEXT], cw_error *err)
{
    CWI_REQUIRE(err, camera, text);
    char n[10][CWI_JSON_NUMBER];
    const bool flat = camera->fov_deg == 0;
    double axes[3][3];
    cw_status st = cw_camera_axes(camera, axes[0], axes[1], axes[2], err);
    if (st != CW_OK)
        return st;
    void *before = cwi_locale_c();
    for (int a = 0; a < 3; a++) {
        cwi_json_double(n[a], camera->eye[a]);
        cwi_json_double(n[3 + a], camera->target[a]);
        cwi_json_double(n[6 + a], camera->up[a]);
    }
    cwi_json_double(n[9], flat ? camera->height_mm : camera->fov_deg);
    snprintf(text, CW_CAMERA_TEXT,
             "{\"schema\": \"%s\",\n \"eye\": [%s, %s, %s],\n"
             " \"target\": [%s, %s, %s],\n \"up\": [%s, %s, %s],\n"
             " \"%s\": %s}\n",
             schema, n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8],
             flat ? "height_mm" : "fov_deg", n[9]);
    cwi_locale_restore(before);
    return CW_OK;
}

cw_status cw_camera_write(const char *path, const cw_camera *camera, cw_error *err)
{
    CWI_REQUIRE(err, path, camera);
    char text[CW_CAMERA_TEXT];
    cw_status st = cw_camera_format(camera, text, err);
    return st == CW_OK ? cwi_outfile_save(path, text, strlen(text), err) : st;
}
