#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# Relighting by hand: sliders are moved in a browser, and the page then shows what igi relight makes of
# lamps scaled alike.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"

sed 's/"lights": \[/"lights": [ { "type": "point", "position": [0.8, 0.8, 1], "intensity": [1, 1, 1] },/' \
    "$tests/cli/mini.json" >spec.json
expect 0 "" "$igi" synth -q spec.json -o room
expect 0 "" "$igi" recover -q room -o out --model lambert
expect 2 'there is no such option' "$igi" recover room --relight -o out
expect 0 "" "$igi" report -q out --relight --samples 128
[ -s out/relight/1.1.png ] || fail "no basis picture"
cat >lights.json <<'END'
{ "lights": [ { "type": "point", "position": [0.8, 0.8, 1], "intensity": [2, 0.4317210, 0] },
              { "type": "area", "region": "panel", "radiance": [3, 3, 3] } ] }
END
expect 0 "" "$igi" relight -q out --lights lights.json --cameras room/transforms.json \
    --samples 64 --seed 9 -o relit
mv room elsewhere
expect 3 'give their file with --cameras' "$igi" report -q out --relight
mv elsewhere room

cat >probe.js <<'END'
addEventListener('load',()=>{const box=document.getElementById('relight');
const lamps=box.querySelectorAll('.lamp');
const set=(e,v)=>{e.value=v;e.dispatchEvent(new Event('input',{bubbles:true}))};
set(lamps[0].querySelector('.power'),2);set(lamps[0].querySelector('.colour'),'#ff8000');
set(lamps[1].querySelector('.power'),.5);
const c=box.querySelectorAll('canvas')[1],d=c.getContext('2d').getImageData(0,0,c.width,c.height).data;
const out=[];for(let y=0;y<c.height;y+=8)for(let x=0;x<c.width;x+=8)for(let k=0;k<3;k++){let s=0;
for(let j=y;j<y+8;j++)for(let i=x;i<x+8;i++)s+=d[4*(j*c.width+i)+k];out.push((s/64).toFixed(3))}
document.body.dataset.blocks=out.join(' ');set(box.querySelector('.how'),'heat');
const h=c.getContext('2d').getImageData(0,0,1,1).data;document.body.dataset.heat=h.join(' ')});
END
grep -q '</body></html>$' out/report.html || fail "the page ends otherwise"
sed 's|</script></body></html>|</script>|' out/report.html >page.html
{
    echo "<script>"
    cat probe.js
    echo "</script></body></html>"
} >>page.html
browse "$work/page.html"
grep -q 'data-errors="0"' dom || fail "errors: $(grep -o 'data-errors="[^"]*"' dom)"
sed -n 's/.*data-blocks="\([^"]*\)".*/\1/p' dom | tr ' ' '\n' >shown
exposure=$(sed -n 's/.*id="relight" data-exposure="\([^"]*\)".*/\1/p' out/report.html)
"$build/pixels" relit/0003.exr "$exposure" 8 >want || fail "no picture to compare with"
[ "$(wc -l <shown)" -eq 144 ] || fail "$(wc -l <shown) numbers of the page, not 144"
# Blocks of 64 pixels: the noise of both is below half a level.
paste shown want | awk '{ d = $1 - $2; if (d < 0) d = -d; s += d; if (d > m) m = d; t += $2 }
    END { printf "mean %.3f, largest %.3f of 255, mean level %.1f\n", s / NR, m, t / NR
          exit !(s / NR < 0.8 && m < 5 && t / NR > 20) }' >differences ||
    fail "the page differs from igi relight: $(cat differences)"
cat differences
grep -q 'data-heat="[0-9]* [0-9]* [0-9]* 255"' dom || fail "no false colour"
finish
