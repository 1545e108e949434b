#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# From photographs to radiance images: merge, calibrate, correct.
# shellcheck source=tests/check.sh
. "$(dirname "$0")/../check.sh"
data=${IGI_SHARED_DATA:-$(dirname "$0")/../../../shared/data}/real

expect 2 'where to\?' "$igi" merge a.jpg
expect 2 'name the images, or a --list' "$igi" merge -o x.exr
expect 2 'ends in \.exr' "$igi" merge a.jpg -o x.png
expect 2 'is in metres' "$igi" calibrate a.jpg -o x.json --chessboard 9x6 --square 25
expect 3 'named twice' "$igi" calibrate a.jpg a.jpg -o x.json --chessboard 9x6 --square .025
expect 3 'calibrate --convert' "$igi" correct a.exr -o out --calibration lens.yml
expect 2 'not both' "$igi" merge a.jpg --list b -o x.exr
expect 2 'must be one of' "$igi" merge a.jpg -o x.exr --weights guess
expect 3 'nowhere\.jpg: cannot be opened' "$igi" merge nowhere.jpg -o x.exr
expect 3 'nowhere\.txt: cannot be opened' "$igi" merge --list nowhere.txt -o x.exr
expect 3 'guess: ' "$igi" merge a.jpg -o x.exr --response guess
expect 2 'what do the images show' "$igi" calibrate a.jpg -o x.json
expect 2 'inner corners' "$igi" calibrate a.jpg -o x.json --chessboard 9by6
expect 2 'how large are the squares' "$igi" calibrate a.jpg -o x.json --chessboard 9x6
expect 2 'how large are the markers' "$igi" calibrate a.jpg -o x.json --charuco 7x5 --square .03
expect 2 'how large are the markers' "$igi" calibrate a.jpg -o x.json --charuco 7x5 --square .03 \
    --marker .04
expect 2 'one photograph' "$igi" calibrate a.jpg b.jpg -o x.json --lensfun
expect 2 'name the board' "$igi" calibrate a.jpg --flat -o x.json --residuals x.svg
expect 2 'name the images' "$igi" calibrate --flat -o x.json
expect 2 'name no others' "$igi" calibrate --overlap a b.exr -o x.json
expect 3 'nowhere' "$igi" calibrate --overlap nowhere -o x.json
expect 3 'nowhere\.jpg' "$igi" calibrate nowhere.jpg --flat -o x.json
expect 2 'by what\?' "$igi" correct a.exr -o out
expect 3 'nowhere\.json' "$igi" correct a.exr -o out --calibration nowhere.json
expect 2 'one file' "$igi" correct a/x.exr b/x.exr -o out --calibration nowhere.json
[ "$(find . -type f | wc -l)" -eq 2 ] || fail "left behind: $(ls)"
[ -d "$data/hdr_frobisher_canon" ] || skip "no $data (set IGI_SHARED_DATA to the data folder)"

canon=$data/hdr_frobisher_canon
expect 0 '' "$igi" merge -q "$canon"/IMG_260?.jpg -o canon.exr --save-response canon.json
[ -s canon.exr ] || fail "no canon.exr"
grep -q '"response"' canon.json || fail "no response in canon.json"
expect 0 '' "$igi" merge -q "$canon"/IMG_260?.jpg -o again.exr --threads 1
cmp -s canon.exr again.exr || fail "the same photographs give other bytes"
expect 0 'merge' "$igi" merge --json "$canon"/IMG_260?.jpg -o again.exr --response canon.json
stdout '"file": .*IMG_2600.jpg", "stated": 0.00195'
stdout '"shift": \[0, 0\]'

expect 3 'holds radiance already' "$igi" merge -q canon.exr -o again.exr
expect 3 'give the EMoR model.s invemor.txt' "$igi" merge -q "$canon"/IMG_260?.jpg -o again.exr \
    --response emor --basis "$data/camera_response/emor.txt"
living=$data/hdr_ssarcandy_living_room1
awk -v d="$living" '/^DSC/ { print d "/" $1, $2 }' "$living/image_list.txt" >living.txt
expect 3 'DSC_0072.png: false exposures: .*DSC_0075' "$igi" merge -q --list living.txt -o living.exr
[ ! -e living.exr ] || fail "living.exr written in spite of false exposures"

expect 0 '' "$igi" calibrate -q --chessboard 9x6 --square .025 "$data"/calib_opencv_left/left0*.jpg \
    -o left.json --residuals left.svg
[ "$(grep -c '<path stroke="#3465a4"' left.svg)" -eq 9 ] || fail "left.svg does not show nine views"
grep -q 'left02.jpg' left.svg || fail "left.svg does not name left02.jpg"
python3 - left.json <<'PYTHON' || fail "left.json is not as it should be"
import json, sys
c = json.load(open(sys.argv[1]))
assert c["rms_px"] < .23 and len(c["views"]) == 9 and c["views"][0]["file"] == "left01.jpg", c
assert abs(c["fl_x"] - 533) < 3 and c["w"] == 640 and c["std"]["fl_x"] > 0, c
PYTHON
expect 3 'whole board of 8 x 5' "$igi" calibrate -q --chessboard 8x5 --square .025 \
    "$data"/calib_opencv_left/left0[12].jpg -o no.json
[ ! -e no.json ] || fail "no.json written without a lens"
expect 3 '640 x 426 pixels, and the calibration is for 640 x 480' \
    "$igi" correct -q canon.exr --calibration left.json -o out
sed 's/"h": 480/"h": 426/' left.json >low.json
expect 0 '' "$igi" correct -q canon.exr again.exr --calibration low.json -o out
for name in canon.exr again.exr camera.json manifest.json; do
    [ -s "out/$name" ] || fail "no out/$name"
done
finish
