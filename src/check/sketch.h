/* SPDX-License-Identifier: Apache-2.0
 *
 * check.html: what its parts share.
 */
#ifndef IGI_SRC_CHECK_SKETCH_H
#define IGI_SRC_CHECK_SKETCH_H

#include "check/case.h"
#include "check/view.h"
#include "image/resample.h"
#include "report/page.h"

/* The room from outside: two ways from above, one from below, and straight down. */
enum { IGI_ROOM_ABOVE, IGI_ROOM_OPPOSITE, IGI_ROOM_BELOW, IGI_ROOM_PLAN, IGI_ROOMS };

typedef struct igi_sketch {
    const igi_page *page;
    const igi_case *c;
    bool *cut;
    igi_view rooms[IGI_ROOMS];
    uint8_t *colours; /* [2 patches][3] */
    float exposure;   /* of photographs */
    size_t *lamp_pixels,
        *mirrored; /* [frames] pixels of lamps; places that mirror one, of a grid */
} igi_sketch;

/* Colours of all sides. */
extern const uint8_t igi_never_seen[3], igi_seen_once[3], igi_mirrors[3];
void igi_colour_views(const igi_sketch *s);    /* how many photographs show a side */
void igi_colour_angles(const igi_sketch *s);   /* angle of the best view from the normal */
void igi_colour_radiance(const igi_sketch *s); /* what they show; never, once seen: marked */
void igi_colour_fronts(const igi_sketch *s);
void igi_colour_albedo(const igi_sketch *s);     /* first estimates; above one: marked */
void igi_colour_highlights(const igi_sketch *s); /* regions whose highlight is seen or not */
/* One number for each region, from white to red at `top`; NaN: grey. */
void igi_colour_shares(const igi_sketch *s, double (*share)(const igi_region_check *), double top);
/* What a photograph shows against the mean of all, from its pixels and what they show. */
IGI_MUST_USE igi_status igi_colour_against(const igi_sketch *s, const igi_image *image,
                                           const igi_view *view);

/* Of a photograph, at most: what observing keeps of it. */
enum { IGI_SNAPSHOT_SIDE = 300 };
/* A photograph at most `side` pixels wide and high, in sRGB, and what its pixels show. */
typedef struct igi_snapshot {
    size_t frame;
    igi_view view;
    igi_image *image; /* linear, as recovery scales it */
    uint8_t *pixels;  /* red, green, blue */
} igi_snapshot;
IGI_MUST_USE igi_status igi_snapshot_take(const igi_sketch *s, size_t frame, int side,
                                          igi_snapshot *snapshot);
void igi_snapshot_clear(igi_snapshot *snapshot);
IGI_MUST_USE igi_status igi_snapshot_print(const igi_sketch *s, const igi_snapshot *snapshot,
                                           const char *label);
void igi_snapshot_mark_edges(igi_snapshot *snapshot);
void igi_snapshot_mark_lamps(igi_snapshot *snapshot);
void igi_snapshot_mark_saturated(const igi_sketch *s, igi_snapshot *snapshot);
/* Outlines where surfaces (of a region; -1: any) mirror a lamp; pixels of 3 or 4 channels. Returns the
 * share of the picture. */
IGI_MUST_USE igi_status igi_mark_highlights(const igi_sketch *s, const igi_view *view, int region,
                                            uint8_t *pixels, int channels, double *share);

/* The view in the present colours: an <img>. */
IGI_MUST_USE igi_status igi_sketch_view(const igi_sketch *s, const igi_view *view,
                                        const char *label);
/* An <svg> over a view: the cameras, and those that are proposed, with letters. */
void igi_sketch_cameras(const igi_sketch *s, const igi_view *view);
/* The letter of the place that an assumption's remedy proposes, counted over all: 'A' ..; 0: none. */
char igi_sketch_letter(const igi_sketch *s, const igi_assumption *a);
/* A coloured square and what it stands for. */
void igi_sketch_key(const igi_sketch *s, const uint8_t colour[3], const char *text);
/* A ramp from its stop number `first` on, with its ends. */
void igi_sketch_ramp(const igi_sketch *s, const uint8_t ramp[IGI_RAMP_STOPS][3], int first,
                     const char *const ends[2]);

/* An assumption on the page; NULL: it has no card. */
typedef struct igi_topic {
    const char *name, *title, *why;
    igi_status (*draw)(const igi_sketch *s, const igi_assumption *a);
} igi_topic;
const igi_topic *igi_topic_of(const igi_assumption *a);

/* The page's sections. */
IGI_MUST_USE igi_status igi_sketch_assumptions(const igi_sketch *s);
IGI_MUST_USE igi_status igi_sketch_coverage(const igi_sketch *s);
IGI_MUST_USE igi_status igi_sketch_proposals(const igi_sketch *s);
IGI_MUST_USE igi_status igi_sketch_photographs(const igi_sketch *s);
void igi_sketch_lights(const igi_sketch *s);

/* Charts of the photographs, <svg>. */
void igi_chart_contradictions(const igi_sketch *s);
void igi_chart_gains(const igi_sketch *s);
void igi_chart_offsets(const igi_sketch *s);
void igi_chart_growth(const igi_sketch *s);

/* FOLDER/check.html. */
IGI_MUST_USE igi_status igi_sketch_save(const igi_case *c, const char *folder);

#endif
