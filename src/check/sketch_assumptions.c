/* SPDX-License-Identifier: Apache-2.0
 *
 * A card for each assumption: does it hold, why it matters, what was found, what to do, a picture.
 */
#include "check/sketch.h"

static void print_badge(const igi_sketch *s, igi_verdict verdict)
{
    static const char *const signs[] = {"&#10003;", "?", "&#10007;"};
    fprintf(s->page->file, "<span class=\"badge v%d\">%s&nbsp;%s</span>", (int)verdict,
            signs[verdict], igi_verdict_name(verdict));
}

static igi_status print_card(const igi_sketch *s, const igi_assumption *a)
{
    FILE *f = s->page->file;
    const igi_topic *topic = igi_topic_of(a);
    char letter = igi_sketch_letter(s, a);
    if (!topic) return IGI_OK;
    fprintf(f, "<div class=\"card assumption\" id=\"%s\"><div><h3>", a->name);
    print_badge(s, a->verdict);
    fprintf(f, " %s</h3><p class=\"soft\">%s</p><p>Found: ", topic->title, topic->why);
    igi_page_text(s->page, a->finding);
    fputs(".</p>", f);
    if (a->remedy) {
        fputs("<p class=\"remedy\"><b>What to do:</b> ", f);
        igi_page_text(s->page, a->remedy);
        if (letter) fprintf(f, " (view <a href=\"#view-%c\"><b>%c</b></a>)", letter, letter);
        fputs(".</p>", f);
    }
    fputs("</div><div class=\"pictures\">", f);
    IGI_TRY(topic->draw(s, a));
    fputs("</div></div>\n", f);
    return IGI_OK;
}

igi_status igi_sketch_assumptions(const igi_sketch *s)
{
    const igi_check *check = s->c->check;
    FILE *f = s->page->file;
    fputs("<section><h2>Assumptions</h2><p class=\"soft\">Each holds, is doubtful (recovery runs, "
          "warns, and its error bars grow), or fails (recovery has no answer). The worst come "
          "first.</p><p class=\"chips\">",
          f);
    for (size_t i = 0; i < check->assumption_count; i++) {
        const igi_assumption *a = &check->assumptions[i];
        fprintf(f, "<a class=\"chip v%d\" href=\"#%s\">%s</a> ", (int)a->verdict, a->name,
                igi_topic_of(a) ? igi_topic_of(a)->title : a->name);
    }
    fputs("</p>\n", f);
    for (int verdict = IGI_FAILS; verdict >= IGI_HOLDS; verdict--) {
        if (verdict == IGI_HOLDS) fputs("<div class=\"holding\">", f);
        for (size_t i = 0; i < check->assumption_count; i++)
            if ((int)check->assumptions[i].verdict == verdict)
                IGI_TRY(print_card(s, &check->assumptions[i]));
    }
    fputs("</div></section>\n", f);
    return IGI_OK;
}
