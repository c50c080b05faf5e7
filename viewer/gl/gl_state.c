/* Makes the context the drawing thread's, and frees the data uploaded to it. */
#include "viewer/gl/gl_internal.h"

bool cwi_gl_enter(cwi_gl *gl)
{
    return cwi_gl_context_enter(&gl->context);
}

void cwi_gl_leave(cwi_gl *gl)
{
    cwi_gl_context_leave(&gl->context);
}

void cwi_gl_drop_scene(cwi_gl *gl)
{
    gl->drop_states(gl);
    cwi_gl_drop_volume(gl);
    cwi_gl_drop_transfer(gl);
}
