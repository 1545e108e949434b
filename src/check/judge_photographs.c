/* SPDX-License-Identifier: Apache-2.0
 *
 * What the photographs say of each other and of the cameras.
 */
#include "check/judge.h"

#include <math.h>

#define FEWEST_PLACES 20
#define SATURATED 5e-4
#define FAILING_PX 3.0

/* The first of the photographs that `is` says yes to; how many there are. */
static size_t count_photos(const igi_case *c, bool (*is)(const igi_case *c, size_t frame),
                           size_t *first)
{
    size_t n = 0;
    for (size_t f = 0; f < c->check->photo_count; f++)
        if (is(c, f) && n++ == 0) *first = f;
    return n;
}

static bool is_alone(const igi_case *c, size_t f)
{
    return c->faults->frames[f].contradicts;
}

static bool is_unshared(const igi_case *c, size_t f)
{
    return c->agreement->frames[f].places < FEWEST_PLACES;
}

static bool is_scaled(const igi_case *c, size_t f)
{
    return c->faults->frames[f].scale != 1;
}

static bool is_saturated(const igi_case *c, size_t f)
{
    return c->check->photos[f].saturated > SATURATED;
}

static bool is_off(const igi_case *c, size_t f)
{
    return c->faults->frames[f].off;
}

static igi_status judge_static(const igi_case *c)
{
    size_t first = 0, n = count_photos(c, is_alone, &first), lonely = 0,
           all = c->check->photo_count;
    igi_assumption *a = igi_case_add(c, "static");
    if (c->faults->divided) {
        IGI_TRY(igi_case_find(c, a, IGI_FAILS, (double)n,
                              "%zu of %zu photographs contradict the others", n, all));
        return igi_case_remedy(c, a, NULL,
                               "check that cameras, mesh and photographs belong together, and that "
                               "nothing moved between them");
    }
    if (n > 0) {
        a->frame = (int)first;
        IGI_TRY(igi_case_find(
            c, a, IGI_DOUBTFUL, (double)n,
            "%zu of %zu photographs contradict the others (image %s at %.0f %% of "
            "the places they share) and will be left out",
            n, all, c->check->photos[first].name, 100 * c->check->photos[first].contradicts));
        return igi_case_remedy(c, a, NULL, "take image %s again from its camera's place",
                               c->check->photos[first].name);
    }
    size_t unshared = count_photos(c, is_unshared, &lonely);
    if (2 * unshared > all) {
        IGI_TRY(igi_case_find(c, a, IGI_DOUBTFUL, (double)unshared,
                              "%zu of %zu photographs share too little with two others to be "
                              "compared",
                              unshared, all));
        return igi_case_remedy(c, a, NULL, "add photographs that overlap");
    }
    double most = 0;
    for (size_t f = 0; f < all; f++) most = fmax(most, c->check->photos[f].contradicts);
    return igi_case_find(c, a, IGI_HOLDS, most,
                         "no photograph is alone at more than %.1f %% of the places that it shares "
                         "with others",
                         100 * most);
}

static igi_status judge_exposure(const igi_case *c)
{
    size_t first = 0, n = count_photos(c, is_scaled, &first);
    igi_assumption *a = igi_case_add(c, "exposure");
    if (c->faults->drifts) {
        IGI_TRY(igi_case_find(c, a, IGI_DOUBTFUL, c->faults->gain_spread,
                              "exposures differ by %.1f %%; each photograph will be scaled to the "
                              "others",
                              100 * c->faults->gain_spread));
        return igi_case_remedy(c, a, NULL, "lock exposure and white balance");
    }
    size_t lonely = 0;
    if (2 * count_photos(c, is_unshared, &lonely) > c->check->photo_count) {
        IGI_TRY(igi_case_find(c, a, IGI_DOUBTFUL, (double)NAN,
                              "exposures cannot be compared: the photographs share too little"));
        return igi_case_remedy(c, a, NULL, "add photographs that overlap");
    }
    if (n == 0)
        return igi_case_find(c, a, IGI_HOLDS, c->faults->gain_spread,
                             "exposures agree within %.2f %%", 100 * c->faults->gain_spread);
    a->frame = (int)first;
    IGI_TRY(igi_case_find(c, a, IGI_DOUBTFUL, c->check->photos[first].gain,
                          "%zu photograph%s of another exposure (image %s: %.3g times as bright) "
                          "will be scaled to the others",
                          n, n == 1 ? "" : "s", c->check->photos[first].name,
                          c->check->photos[first].gain));
    return igi_case_remedy(c, a, NULL, "correct the exposure of image %s",
                           c->check->photos[first].name);
}

static igi_status judge_saturation(const igi_case *c)
{
    size_t first = 0, n = count_photos(c, is_saturated, &first);
    igi_assumption *a = igi_case_add(c, "unclipped");
    double most = 0;
    for (size_t f = 0; f < c->check->photo_count; f++) {
        if (c->check->photos[f].saturated <= most) continue;
        most = c->check->photos[f].saturated;
        first = f;
    }
    if (n == 0)
        return igi_case_find(c, a, IGI_HOLDS, most, "no photograph is saturated%s",
                             most > 0 ? " but for a few pixels" : "");
    a->frame = (int)first;
    IGI_TRY(igi_case_find(c, a, IGI_DOUBTFUL, most,
                          "%zu of %zu photographs are saturated (image %s on %.2f %% of its "
                          "pixels): their highlights are lost",
                          n, c->check->photo_count, c->check->photos[first].name, 100 * most));
    return igi_case_remedy(c, a, NULL, "add shorter exposures and merge them");
}

static igi_status judge_registration(const igi_case *c)
{
    size_t first = 0, n = count_photos(c, is_off, &first), known = 0;
    igi_assumption *a = igi_case_add(c, "registered");
    double typical = c->faults->offset_px;
    for (size_t f = 0; f < c->check->photo_count; f++) known += c->check->photos[f].edges > 0;
    if (known == 0) {
        IGI_TRY(igi_case_find(c, a, IGI_DOUBTFUL, (double)NAN,
                              "no photograph has enough clear edges to check its camera by"));
        return igi_case_remedy(c, a, NULL, "compare a rendering of the mesh with the photographs");
    }
    if (c->faults->all_off) {
        IGI_TRY(igi_case_find(c, a, typical > FAILING_PX ? IGI_FAILS : IGI_DOUBTFUL, typical,
                              "edges lie %.1f pixels off the mesh's in the typical photograph",
                              typical));
        return igi_case_remedy(c, a, NULL,
                               "register the cameras again (igi register), or mend the mesh");
    }
    if (n == 0)
        return igi_case_find(c, a, IGI_HOLDS, typical,
                             "edges lie within %.2f pixels of the mesh's in the typical "
                             "photograph (%zu of %zu have enough)",
                             typical, known, c->check->photo_count);
    a->frame = (int)first;
    const igi_photo_check *p = &c->check->photos[first];
    double off = hypot(p->offset[0], p->offset[1]);
    IGI_TRY(igi_case_find(c, a, IGI_DOUBTFUL, off,
                          "%zu camera%s off (image %s by %.1f pixels: %+.1f columns, %+.1f rows)",
                          n, n == 1 ? " is" : "s are", p->name, off, p->offset[0], p->offset[1]));
    return igi_case_remedy(c, a, NULL, "register the camera of image %s again", p->name);
}

igi_status igi_judge_photographs(const igi_case *c)
{
    IGI_TRY(judge_static(c));
    IGI_TRY(judge_exposure(c));
    IGI_TRY(judge_saturation(c));
    return judge_registration(c);
}
