/* SPDX-License-Identifier: Apache-2.0
 *
 * The photographs with what is predicted and found on them; the lights.
 */
#include "check/sketch.h"

#include "material/material.h"

enum { MOST_SHOWN = 9 };

/* Those that an assumption names, then those with most highlights. */
static igi_status choose(const igi_sketch *s, bool **chosen)
{
    const igi_check *check = s->c->check;
    size_t n = 0;
    IGI_TRY(IGI_ALLOC(s->c->ctx, check->photo_count, chosen));
    for (size_t i = 0; i < check->assumption_count && n < MOST_SHOWN; i++) {
        int frame = check->assumptions[i].frame;
        if (frame < 0 || (*chosen)[frame]) continue;
        (*chosen)[frame] = true;
        n++;
    }
    for (; n < MOST_SHOWN && n < check->photo_count; n++) {
        size_t best = SIZE_MAX;
        for (size_t f = 0; f < check->photo_count; f++)
            if (!(*chosen)[f] && (best == SIZE_MAX || s->mirrored[f] > s->mirrored[best])) best = f;
        (*chosen)[best] = true;
    }
    return IGI_OK;
}

static igi_status print_photo(const igi_sketch *s, size_t frame)
{
    igi_status status = IGI_OK;
    FILE *f = s->page->file;
    const igi_photo_check *p = &s->c->check->photos[frame];
    igi_snapshot snap;
    double share;
    IGI_TRY(igi_snapshot_take(s, frame, IGI_SNAPSHOT_SIDE, &snap));
    igi_snapshot_mark_saturated(s, &snap);
    igi_snapshot_mark_lamps(&snap);
    IGI_TRY_GOTO(igi_mark_highlights(s, &snap.view, -1, snap.pixels, 3, &share));
    fputs("<figure>", f);
    IGI_TRY_GOTO(igi_snapshot_print(s, &snap, "photograph with marks"));
    fputs("<figcaption><b>", f);
    igi_page_text(s->page, p->name);
    fprintf(f, "</b>: %.1f&nbsp;%% of it would mirror a lamp", 100 * share);
    if (p->saturated > 0) fprintf(f, ", %.2f&nbsp;%% saturated", 100 * p->saturated);
    if (p->left_out) fputs("; will be left out", f);
    fputs("</figcaption></figure>\n", f);
cleanup:
    igi_snapshot_clear(&snap);
    return status;
}

static void print_row(const igi_sketch *s, size_t frame)
{
    FILE *f = s->page->file;
    const igi_photo_check *p = &s->c->check->photos[frame];
    fputs("<tr><td class=\"l\">", f);
    igi_page_text(s->page, p->name);
    fprintf(f,
            "</td><td data-v=\"%.6g\">%+.2f&nbsp;%% <span class=\"soft\">&plusmn;&nbsp;%.2f"
            "</span></td><td data-v=\"%.6g\">%.1f&nbsp;%%</td><td data-v=\"%.6g\">%.2f&nbsp;%%"
            "</td><td data-v=\"%zu\">%zu</td>",
            p->gain, 100 * (p->gain - 1), 100 * p->gain_error, p->contradicts, 100 * p->contradicts,
            p->saturated, 100 * p->saturated, p->edges, p->edges);
    if (p->edges == 0) fputs("<td data-v=\"-1\">&ndash;</td>", f);
    else
        fprintf(f,
                "<td data-v=\"%.6g\">%+.2f, %+.2f <span class=\"soft\">&plusmn;&nbsp;%.2f</span>"
                "</td>",
                hypot(p->offset[0], p->offset[1]), p->offset[0], p->offset[1], p->offset_error);
    fprintf(f, "<td class=\"l\">%s</td></tr>\n",
            p->left_out                       ? "left out"
            : p->scaled                       ? "scaled to the others"
            : s->c->faults->frames[frame].off ? "used; its camera is off"
                                              : "used");
}

static void print_table(const igi_sketch *s)
{
    static const char *const headings[] = {"gain", "alone", "saturated", "edges", "offset, px"};
    FILE *f = s->page->file;
    fputs("<p class=\"soft\" style=\"margin-top:1.2rem\">Of each photograph: its gain against the "
          "others; the share of shared places at which it is alone with what it shows; its "
          "saturated pixels; the edges found beside the mesh's, and how far they lie off to the "
          "right and down.</p><div class=\"card scroll\" tabindex=\"0\"><table><thead><tr><th "
          "class=\"l\"><button "
          "type=\"button\">photograph</button></th>",
          f);
    for (size_t i = 0; i < sizeof headings / sizeof headings[0]; i++)
        fprintf(f, "<th><button type=\"button\">%s</button></th>", headings[i]);
    fputs("<th class=\"l\">what recovery does</th></tr></thead><tbody>\n", f);
    for (size_t i = 0; i < s->c->check->photo_count; i++) print_row(s, i);
    fputs("</tbody></table></div>", f);
}

igi_status igi_sketch_photographs(const igi_sketch *s)
{
    static const uint8_t lamps[3] = {255, 120, 0};
    FILE *f = s->page->file;
    bool *chosen = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(choose(s, &chosen));
    fputs("<section><h2>Photographs</h2><p>What is predicted and found, marked on the photographs "
          "that an assumption names and on those with most highlights. A surface shines where it "
          "mirrors a lamp, if it is glossy at all: that is where gloss is measured.</p><p>",
          f);
    igi_sketch_key(s, igi_mirrors, "would mirror a lamp");
    igi_sketch_key(s, igi_never_seen, "saturated");
    igi_sketch_key(s, lamps, "lamp");
    fputs("</p><div class=\"three\">", f);
    for (size_t i = 0; i < s->c->check->photo_count; i++)
        if (chosen[i]) IGI_TRY_GOTO(print_photo(s, i));
    fputs("</div>", f);
    print_table(s);
    fputs("</section>\n", f);
cleanup:
    igi_free(chosen);
    return status;
}

void igi_sketch_lights(const igi_sketch *s)
{
    FILE *f = s->page->file;
    if (s->c->check->light_count == 0) return;
    fputs("<section><h2>Lights</h2><div class=\"card scroll\" tabindex=\"0\"><table><thead><tr><th "
          "class=\"l\">"
          "light</th><th class=\"l\">kind</th><th class=\"l\">in the photographs</th><th "
          "class=\"l\">its power</th></tr></thead><tbody>\n",
          f);
    for (size_t i = 0; i < s->c->check->light_count; i++) {
        const igi_light_check *l = &s->c->check->lights[i];
        bool area = l->type == IGI_LIGHT_AREA;
        fputs("<tr><td class=\"l\">", f);
        igi_page_text(s->page, l->name);
        fprintf(f,
                "</td><td class=\"l\">%s</td><td class=\"l\">%s</td><td class=\"l\">%s</td></tr>",
                igi_light_type_name(l->type),
                l->seen ? "shown"
                : area  ? "in none"
                        : "has no surface to see",
                l->known  ? "given"
                : l->seen ? "read from the photographs"
                          : "solved for");
    }
    fputs("</tbody></table></div></section>\n", f);
}
