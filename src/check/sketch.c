/* SPDX-License-Identifier: Apache-2.0 */
#include "check/sketch.h"

#include "scene/camera.h"

#define WEDGE 0.05f /* of the scene's size: how large a camera is drawn */

igi_status igi_sketch_view(const igi_sketch *s, const igi_view *view, const char *label)
{
    uint8_t *pixels = NULL;
    igi_status status = igi_view_paint(s->c->ctx, view, s->colours, &pixels);
    if (status == IGI_OK)
        status = igi_page_pixels(s->page, pixels, view->width, view->height, 4, label);
    igi_free(pixels);
    return status;
}

/* A pyramid from the eye to the corners of what a camera sees, seen from outside. */
static void draw_wedge(const igi_sketch *s, const igi_view *view, igi_vec eye,
                       const igi_vec ways[4], const char *kind)
{
    FILE *f = s->page->file;
    float reach = WEDGE * igi_tracer_size(s->c->survey->tracer, NULL, NULL);
    double x0, y0, x[4], y[4];
    if (!igi_view_project(view, eye, &x0, &y0)) return;
    for (int k = 0; k < 4; k++)
        if (!igi_view_project(view, igi_madd(eye, ways[k], reach), &x[k], &y[k])) return;
    fprintf(f, "<path class=\"%s\" d=\"", kind);
    for (int k = 0; k < 4; k++)
        fprintf(f, "M%.1f %.1fL%.1f %.1fL%.1f %.1f", x0, y0, x[k], y[k], x[(k + 1) % 4],
                y[(k + 1) % 4]);
    fprintf(f, "\"/><circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"2.2\"/>", kind, x0, y0);
}

static bool same_view(const igi_assumption *a, const igi_assumption *b)
{
    for (int k = 0; k < 3; k++)
        if (a->eye[k] != b->eye[k] || a->target[k] != b->target[k]) return false;
    return a->has_view && b->has_view;
}

char igi_sketch_letter(const igi_sketch *s, const igi_assumption *a)
{
    char letter = 'A';
    if (!a->has_view) return 0;
    for (size_t i = 0; i < s->c->check->assumption_count; i++) {
        const igi_assumption *b = &s->c->check->assumptions[i];
        bool is_new = b->has_view;
        if (same_view(a, b)) return letter;
        for (size_t k = 0; k < i; k++) is_new &= !same_view(b, &s->c->check->assumptions[k]);
        letter = (char)(letter + is_new);
    }
    return letter;
}

static void draw_proposal(const igi_sketch *s, const igi_view *view, const igi_assumption *a)
{
    double x, y;
    igi_vec ways[4], eye = igi_v_ofd(a->eye);
    igi_view look;
    igi_view_from(s->c->survey, eye, igi_v_ofd(a->target), 4, &look);
    for (int k = 0; k < 4; k++)
        ways[k] = igi_normalize(
            igi_add(look.forward, igi_add(igi_scale(look.right, k == 0 || k == 3 ? -1.0f : 1.0f),
                                          igi_scale(look.up, k < 2 ? 1.0f : -1.0f))));
    draw_wedge(s, view, eye, ways, "new");
    if (!igi_view_project(view, eye, &x, &y)) return;
    fprintf(s->page->file,
            "<circle class=\"tag\" cx=\"%.1f\" cy=\"%.1f\" r=\"9\"/><text x=\"%.1f\" y=\"%.1f\" "
            "text-anchor=\"middle\">%c</text>",
            x, y, x, y + 4.5, igi_sketch_letter(s, a));
}

void igi_sketch_cameras(const igi_sketch *s, const igi_view *view)
{
    FILE *f = s->page->file;
    fprintf(f, "<svg viewBox=\"0 0 %d %d\" aria-hidden=\"true\">", view->width, view->height);
    for (size_t i = 0; i < s->c->scene->frame_count; i++) {
        const igi_camera *camera = &s->c->scene->frames[i].camera;
        igi_vec ways[4];
        for (int k = 0; k < 4; k++)
            ways[k] = igi_camera_direction(camera, k == 0 || k == 3 ? 0 : camera->width,
                                           k < 2 ? 0 : camera->height);
        draw_wedge(s, view, igi_camera_centre(camera), ways, "cam");
    }
    for (size_t i = 0; i < s->c->check->assumption_count; i++)
        if (s->c->check->assumptions[i].has_view)
            draw_proposal(s, view, &s->c->check->assumptions[i]);
    fputs("</svg>", f);
}

void igi_sketch_key(const igi_sketch *s, const uint8_t colour[3], const char *text)
{
    fprintf(s->page->file,
            "<span class=\"key\"><i style=\"background:#%02x%02x%02x\"></i>%s</span> ", colour[0],
            colour[1], colour[2], text);
}

void igi_sketch_ramp(const igi_sketch *s, const uint8_t ramp[IGI_RAMP_STOPS][3], int first,
                     const char *const ends[2])
{
    FILE *f = s->page->file;
    fputs("<span class=\"ramp\" style=\"display:block;background:linear-gradient(90deg", f);
    for (int i = first; i < IGI_RAMP_STOPS; i++)
        fprintf(f, ",rgb(%d,%d,%d)", ramp[i][0], ramp[i][1], ramp[i][2]);
    fprintf(f, ")\"></span><span class=\"ends\"><span>%s</span><span>%s</span></span>", ends[0],
            ends[1]);
}
