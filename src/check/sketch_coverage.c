/* SPDX-License-Identifier: Apache-2.0
 *
 * What the photographs show of every region; and the places to take more from.
 */
#include "check/sketch.h"

#include <string.h>

enum { PROPOSAL_WIDTH = 340 };

static igi_status print_rooms(const igi_sketch *s, const char *what)
{
    static const char *const names[] = {"from above", "from above, the other side", "from below"};
    FILE *f = s->page->file;
    fputs("<div class=\"three\">", f);
    for (int k = IGI_ROOM_ABOVE; k <= IGI_ROOM_BELOW; k++) {
        fputs("<figure><div class=\"over\">", f);
        IGI_TRY(igi_sketch_view(s, &s->rooms[k], what));
        igi_sketch_cameras(s, &s->rooms[k]);
        fprintf(f, "</div><figcaption>%s</figcaption></figure>", names[k]);
    }
    fputs("</div>", f);
    return IGI_OK;
}

static void print_share(FILE *f, double share)
{
    if (isnan(share)) fputs("<td data-v=\"-1\">&ndash;</td>", f);
    else fprintf(f, "<td data-v=\"%.6g\">%.1f&nbsp;%%</td>", share, 100 * share);
}

static void print_region(const igi_sketch *s, const igi_region_check *r)
{
    FILE *f = s->page->file;
    fputs("<tr><td class=\"l\">", f);
    igi_page_text(s->page, r->name);
    fprintf(f, "</td><td data-v=\"%.6g\">%.3g</td>", r->area, r->area);
    fprintf(f,
            "<td data-v=\"%.6g\"><span class=\"meter\"><i style=\"width:%.0f%%\"></i></span>"
            "<span class=\"share\">%.1f&nbsp;%%</span></td>",
            r->observed, 100 * r->observed, 100 * r->observed);
    print_share(f, r->seen_once);
    fprintf(f, "<td data-v=\"%d\">%d</td>", r->views, r->views);
    if (isnan(r->angle_low_deg)) fputs("<td data-v=\"90\">&ndash;</td>", f);
    else
        fprintf(f, "<td data-v=\"%.6g\">%.0f&deg;&thinsp;&ndash;&thinsp;%.0f&deg;</td>",
                r->angle_low_deg, r->angle_low_deg, r->angle_high_deg);
    print_share(f, r->unseen);
    print_share(f, r->escaped);
    fprintf(f, "<td data-v=\"%d\">%d of %d</td></tr>\n", r->highlights_seen, r->highlights_seen,
            r->highlights_predicted);
}

static void print_regions(const igi_sketch *s)
{
    static const char *const headings[] = {"area, m&sup2;", "photographed",   "only once",
                                           "photographs",   "angles",         "faces unseen",
                                           "faces outside", "highlights seen"};
    FILE *f = s->page->file;
    fputs("<p class=\"soft\" style=\"margin-top:1.2rem\">Of each region: the share of its area in "
          "a photograph, and in one alone; the photographs; their angles from its normal; of what "
          "it faces, the share that no photograph shows and the share outside the mesh; and, of "
          "places looked at that mirror a lamp toward a camera, those with a usable pixel. Click "
          "a heading to sort.</p><div class=\"card scroll\" tabindex=\"0\"><table><thead><tr><th "
          "class=\"l\">"
          "<button type=\"button\">region</button></th>",
          f);
    for (size_t i = 0; i < sizeof headings / sizeof headings[0]; i++)
        fprintf(f, "<th><button type=\"button\">%s</button></th>", headings[i]);
    fputs("</tr></thead><tbody>\n", f);
    for (size_t r = 0; r < s->c->check->region_count; r++)
        if (!s->c->check->regions[r].emitter) print_region(s, &s->c->check->regions[r]);
    fputs("</tbody></table></div>\n", f);
}

igi_status igi_sketch_coverage(const igi_sketch *s)
{
    static const uint8_t few[3] = {178, 209, 232}, some[3] = {104, 160, 208},
                         many[3] = {38, 92, 152};
    FILE *f = s->page->file;
    fputs("<section id=\"coverage\"><h2>Coverage</h2><p>How many photographs show each place. The "
          "room is cut open: walls are left out where one looks at them from outside. Small "
          "pyramids are the cameras, lamps are pale yellow.</p><p>",
          f);
    igi_sketch_key(s, igi_never_seen, "none");
    igi_sketch_key(s, igi_seen_once, "one");
    igi_sketch_key(s, few, "2&ndash;3");
    igi_sketch_key(s, some, "4&ndash;7");
    igi_sketch_key(s, many, "8 or more");
    fputs("</p>", f);
    igi_colour_views(s);
    IGI_TRY(print_rooms(s, "photographs that show each place"));
    fputs("<p style=\"margin-top:1.2rem\">The angle between a surface's normal and the photograph "
          "that looks at it most squarely. Flat views see little and blur much.</p><div "
          "style=\"max-width:26rem\">",
          f);
    igi_sketch_ramp(s, igi_ramp_heat, 0,
                    (const char *[]){"90&deg;: along the surface", "0&deg;: squarely"});
    fputs("</div>", f);
    igi_colour_angles(s);
    IGI_TRY(print_rooms(s, "angle of the best view"));
    print_regions(s);
    fputs("</section>\n", f);
    return IGI_OK;
}

/* The room as one would see it from a place, with what the photographs lack. */
static igi_status print_proposal(const igi_sketch *s, const igi_assumption *a)
{
    igi_status status = IGI_OK;
    FILE *f = s->page->file;
    uint8_t *pixels = NULL;
    igi_view view;
    double share;
    bool highlights = a->region >= 0 && strcmp(a->name, "highlights") == 0;
    igi_view_from(s->c->survey, igi_v_ofd(a->eye), igi_v_ofd(a->target), PROPOSAL_WIDTH, &view);
    IGI_TRY_GOTO(igi_view_look(s->c->ctx, &view));
    igi_colour_radiance(s);
    IGI_TRY_GOTO(igi_view_paint(s->c->ctx, &view, s->colours, &pixels));
    if (highlights) IGI_TRY_GOTO(igi_mark_highlights(s, &view, a->region, pixels, 4, &share));
    fprintf(f, "<figure id=\"view-%c\">", igi_sketch_letter(s, a));
    IGI_TRY_GOTO(igi_page_pixels(s->page, pixels, view.width, view.height, 4,
                                 "the view from the proposed place"));
    fprintf(f, "<figcaption><b>%c</b>: from (%.2f, %.2f, %.2f) m toward (%.2f, %.2f, %.2f) m. ",
            igi_sketch_letter(s, a), a->eye[0], a->eye[1], a->eye[2], a->target[0], a->target[1],
            a->target[2]);
    if (highlights) {
        fputs("Cyan: where &lsquo;", f);
        igi_page_text(s->page, s->c->check->regions[a->region].name);
        fputs("&rsquo; would mirror a lamp into this camera.", f);
    } else {
        fputs("Magenta is what it would show for the first time.", f);
    }
    fputs("</figcaption></figure>\n", f);
cleanup:
    igi_free(pixels);
    igi_view_clear(&view);
    return status;
}

igi_status igi_sketch_proposals(const igi_sketch *s)
{
    const igi_check *check = s->c->check;
    FILE *f = s->page->file;
    char last = 'A' - 1;
    for (size_t i = 0; i < check->assumption_count && last < 'A'; i++)
        if (check->assumptions[i].has_view) last = 'A';
    if (last < 'A') return IGI_OK;
    last = 'A' - 1;
    fputs("<section><h2>Photographs to add</h2><p>Each place lies in free space that a camera has "
          "looked through. The plan is the room from straight above; grey pyramids are the cameras "
          "there are, orange ones those to add. Beside it stands what one would see from there, "
          "put together from the photographs there are.</p><p>",
          f);
    igi_sketch_key(s, igi_never_seen, "in no photograph yet");
    igi_sketch_key(s, igi_seen_once, "tinted: in one");
    fputs("</p><div class=\"three\"><figure><div class=\"over\">", f);
    igi_colour_radiance(s);
    IGI_TRY(igi_sketch_view(s, &s->rooms[IGI_ROOM_PLAN], "plan"));
    igi_sketch_cameras(s, &s->rooms[IGI_ROOM_PLAN]);
    fputs("</div><figcaption>Plan.</figcaption></figure>\n", f);
    for (size_t i = 0; i < check->assumption_count; i++) {
        char letter = igi_sketch_letter(s, &check->assumptions[i]);
        if (letter <= last) continue;
        last = letter;
        IGI_TRY(print_proposal(s, &check->assumptions[i]));
    }
    fputs("</div></section>\n", f);
    return IGI_OK;
}
