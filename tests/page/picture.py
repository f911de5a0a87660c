"""Take the picture of the page that the README shows: ``make picture``."""

from __future__ import annotations

import io
import sys
from pathlib import Path

from PIL import Image

from ikplan_api.settings import Settings

from .browser import Visit, chromium, served


def main(path: Path) -> None:
    """Plan an example in the page and write what is seen, in few colours."""
    with served(Settings(workers=1)) as address, chromium() as browser:
        visit = Visit(browser, address, width=1360, height=900, dark=False)
        page = visit.open("lines_panda", meshes=True, fine=True)
        page.click("#plan")
        page.wait_for_selector("#result .certificate")
        page.locator("#time").evaluate(
            "slider => { slider.value = slider.max * 0.6;"
            " slider.dispatchEvent(new Event('input')); }"
        )
        page.wait_for_timeout(1000)
        picture = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
        visit.close()
    picture.quantize(256, dither=Image.Dither.NONE).save(path, optimize=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
