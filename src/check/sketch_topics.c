/* SPDX-License-Identifier: Apache-2.0
 *
 * What each assumption is called, why it matters, and its pictures.
 */
#include "check/sketch.h"

#include <string.h>

static size_t worst_photo(const igi_sketch *s, const igi_assumption *a,
                          double (*badness)(const igi_photo_check *))
{
    size_t worst = 0;
    if (a->frame >= 0) return (size_t)a->frame;
    for (size_t i = 1; i < s->c->check->photo_count; i++)
        if (badness(&s->c->check->photos[i]) > badness(&s->c->check->photos[worst])) worst = i;
    return worst;
}

static size_t most_of(const size_t *counts, size_t count)
{
    size_t most = 0;
    for (size_t i = 1; i < count; i++)
        if (counts[i] > counts[most]) most = i;
    return most;
}

static void caption(const igi_sketch *s, const char *text, size_t frame)
{
    fputs("<figcaption>", s->page->file);
    fputs(text, s->page->file);
    if (frame != SIZE_MAX) {
        fputs(" Photograph ", s->page->file);
        igi_page_text(s->page, s->c->check->photos[frame].name);
        fputs(".", s->page->file);
    }
    fputs("</figcaption></figure>", s->page->file);
}

static double alone(const igi_photo_check *p)
{
    return p->contradicts;
}

static double clipped(const igi_photo_check *p)
{
    return p->saturated;
}

static double off(const igi_photo_check *p)
{
    return hypot(p->offset[0], p->offset[1]);
}

static igi_status draw_static(const igi_sketch *s, const igi_assumption *a)
{
    FILE *f = s->page->file;
    igi_snapshot snap;
    size_t frame = worst_photo(s, a, alone);
    IGI_TRY(igi_snapshot_take(s, frame, IGI_SNAPSHOT_SIDE / 2, &snap));
    fputs("<figure><div class=\"two\">", f);
    igi_status status = igi_snapshot_print(s, &snap, "the photograph that is alone most often");
    if (status == IGI_OK) status = igi_colour_against(s, snap.image, &snap.view);
    if (status == IGI_OK) status = igi_sketch_view(s, &snap.view, "against the mean of all");
    igi_snapshot_clear(&snap);
    IGI_TRY(status);
    fputs("</div>", f);
    igi_sketch_ramp(s, igi_ramp_spread, 0,
                    (const char *[]){"20&nbsp;% darker than all show it", "20&nbsp;% brighter"});
    caption(s, "Highlights differ from view to view and do no harm; a thing that moved does.",
            frame);
    fputs("<figure>", f);
    igi_chart_contradictions(s);
    caption(s, "Share of its places at which a photograph contradicts the others.", SIZE_MAX);
    return IGI_OK;
}

static igi_status draw_exposure(const igi_sketch *s, const igi_assumption *a)
{
    (void)a;
    fputs("<figure>", s->page->file);
    igi_chart_gains(s);
    caption(s, "How much brighter each photograph is than the others, with 2&thinsp;&sigma;.",
            SIZE_MAX);
    return IGI_OK;
}

/* A photograph with one kind of marks. */
static igi_status draw_marked(const igi_sketch *s, size_t frame, const char *kind, const char *text)
{
    igi_status status = IGI_OK;
    igi_snapshot snap;
    double share;
    IGI_TRY(igi_snapshot_take(s, frame, IGI_SNAPSHOT_SIDE, &snap));
    if (strcmp(kind, "saturated") == 0) igi_snapshot_mark_saturated(s, &snap);
    if (strcmp(kind, "edges") == 0) igi_snapshot_mark_edges(&snap);
    if (strcmp(kind, "lamps") == 0) igi_snapshot_mark_lamps(&snap);
    if (strcmp(kind, "highlights") == 0)
        IGI_TRY_GOTO(igi_mark_highlights(s, &snap.view, -1, snap.pixels, 3, &share));
    fputs("<figure>", s->page->file);
    IGI_TRY_GOTO(igi_snapshot_print(s, &snap, kind));
    caption(s, text, frame);
cleanup:
    igi_snapshot_clear(&snap);
    return status;
}

static igi_status draw_unclipped(const igi_sketch *s, const igi_assumption *a)
{
    return draw_marked(s, worst_photo(s, a, clipped), "saturated",
                       "Magenta: at the largest value that the sensor gives, so the light there "
                       "is unknown.");
}

static igi_status draw_registered(const igi_sketch *s, const igi_assumption *a)
{
    IGI_TRY(draw_marked(s, worst_photo(s, a, off), "edges",
                        "Cyan: the mesh's edges as the camera would see them; they should lie on "
                        "the photograph's."));
    fputs("<figure>", s->page->file);
    igi_chart_offsets(s);
    caption(s, "How far each photograph's edges lie off the mesh's.", SIZE_MAX);
    return IGI_OK;
}

static double escaped_of(const igi_region_check *r)
{
    return r->emitter ? (double)NAN : r->escaped;
}

static double unseen_of(const igi_region_check *r)
{
    return r->emitter ? (double)NAN : r->unseen;
}

static igi_status draw_room(const igi_sketch *s)
{
    fputs("<figure>", s->page->file);
    return igi_sketch_view(s, &s->rooms[IGI_ROOM_ABOVE], "the room from above, cut open");
}

static igi_status draw_shares(const igi_sketch *s, double (*share)(const igi_region_check *),
                              const char *text)
{
    double top = 0.01;
    char high[32];
    for (size_t r = 0; r < s->c->check->region_count; r++)
        top = fmax(top, share(&s->c->check->regions[r]));
    igi_colour_shares(s, share, top);
    IGI_TRY(draw_room(s));
    snprintf(high, sizeof high, "%.3g&nbsp;%%", 100 * top);
    igi_sketch_ramp(s, igi_ramp_spread, IGI_RAMP_STOPS / 2, (const char *[]){"0&nbsp;%", high});
    caption(s, text, SIZE_MAX);
    return IGI_OK;
}

static igi_status draw_closed(const igi_sketch *s, const igi_assumption *a)
{
    (void)a;
    return draw_shares(s, escaped_of,
                       "Share of what each region faces that lies outside the mesh, weighted by "
                       "the cosine as light is.");
}

static igi_status draw_mesh(const igi_sketch *s, const igi_assumption *a)
{
    (void)a;
    igi_colour_fronts(s);
    IGI_TRY(draw_room(s));
    caption(s,
            "Blue: fronts; orange: backs. One colour within a surface is sound, whichever it is; a "
            "mixture is not.",
            SIZE_MAX);
    return IGI_OK;
}

static igi_status draw_lights(const igi_sketch *s, const igi_assumption *a)
{
    (void)a;
    return draw_marked(s, most_of(s->lamp_pixels, s->c->scene->frame_count), "lamps",
                       "Orange: lamps with a surface, in the photograph that shows most of them.");
}

static igi_status draw_energy(const igi_sketch *s, const igi_assumption *a)
{
    (void)a;
    igi_colour_albedo(s);
    IGI_TRY(draw_room(s));
    caption(s,
            "A first estimate of the albedos, good to some per cent. Magenta: above 1, which no "
            "surface has; grey: not known.",
            SIZE_MAX);
    return IGI_OK;
}

static igi_status draw_observed(const igi_sketch *s, const igi_assumption *a)
{
    (void)a;
    igi_colour_views(s);
    IGI_TRY(draw_room(s));
    fputs("<figcaption>", s->page->file);
    igi_sketch_key(s, igi_never_seen, "in no photograph");
    igi_sketch_key(s, igi_seen_once, "in one");
    fputs("blue: in more. From all sides under <a href=\"#coverage\">Coverage</a>.</figcaption>"
          "</figure>",
          s->page->file);
    return IGI_OK;
}

static igi_status draw_surroundings(const igi_sketch *s, const igi_assumption *a)
{
    (void)a;
    return draw_shares(s, unseen_of,
                       "Share of what each region faces that no photograph shows. How bright it is "
                       "there has to be solved for.");
}

static igi_status draw_highlights(const igi_sketch *s, const igi_assumption *a)
{
    (void)a;
    IGI_TRY(draw_marked(s, most_of(s->mirrored, s->c->scene->frame_count), "highlights",
                        "Cyan: where a surface would mirror a lamp into this camera, were it "
                        "glossy."));
    igi_colour_highlights(s);
    IGI_TRY(draw_room(s));
    fputs("<figcaption>", s->page->file);
    igi_sketch_key(s, igi_mirrors, "a photograph shows where the region would shine");
    igi_sketch_key(s, igi_seen_once, "only at edges, or too few pixels");
    igi_sketch_key(s, igi_never_seen, "none does");
    fputs("</figcaption></figure>", s->page->file);
    return IGI_OK;
}

static igi_status draw_conditioned(const igi_sketch *s, const igi_assumption *a)
{
    (void)a;
    fputs("<figure>", s->page->file);
    igi_chart_growth(s);
    caption(s,
            "How much larger an error becomes: of albedo, in pictures under other light (1 / (1 "
            "&minus; mean albedo)); of the light from what is unseen, where it has to be solved.",
            SIZE_MAX);
    return IGI_OK;
}

static const igi_topic topics[] = {
    {"static", "Nothing moves", "All photographs must show one room under one light.", draw_static},
    {"exposure", "One scale of brightness",
     "Radiance is compared across photographs: a gain of one of them would become albedo.",
     draw_exposure},
    {"unclipped", "Nothing is saturated",
     "A clipped pixel says only that it was brighter; highlights are what clips first.",
     draw_unclipped},
    {"registered", "Cameras fit the mesh",
     "Each pixel is given to the surface that the mesh has there.", draw_registered},
    {"closed", "The mesh is closed",
     "Light that comes through a hole of the mesh comes from nowhere.", draw_closed},
    {"mesh", "Faces are sound",
     "A face that lies on another, or that is turned around, hides or mistakes a surface.",
     draw_mesh},
    {"lights", "Lights are known",
     "Without the power of one light, bright lamps and dark surfaces look like the opposite.",
     draw_lights},
    {"energy", "Energy is conserved",
     "No surface sends on more light than arrives; if one seems to, a light is missing or too "
     "weak.",
     draw_energy},
    {"observed", "Surfaces are photographed", "The albedo of what no photograph shows is a guess.",
     draw_observed},
    {"surroundings", "Surroundings are photographed",
     "The light that arrives at a surface is looked up in photographs of what the surface faces.",
     draw_surroundings},
    {"highlights", "Highlights are photographed",
     "How glossy a surface is shows only where it mirrors a lamp toward a camera.",
     draw_highlights},
    {"conditioned", "Errors stay small",
     "In a bright room light is reflected many times, and so are errors.", draw_conditioned},
};

const igi_topic *igi_topic_of(const igi_assumption *a)
{
    for (size_t i = 0; i < sizeof topics / sizeof topics[0]; i++)
        if (strcmp(topics[i].name, a->name) == 0) return &topics[i];
    return NULL;
}
