"""Measure the frames a second of a motion among obstacles: ``python -m tests.page.frames``."""

from __future__ import annotations

import sys

from ikplan_api.settings import Settings

from .actions import example, plan, write
from .browser import Visit, chromium, served

_OBSTACLES = 20
_MEASURE_S = 4.0
_COUNT = """async seconds => {
    let frames = 0;
    const end = performance.now() + 1000 * seconds;
    while (performance.now() < end) {
        await new Promise(requestAnimationFrame);
        frames += 1;
    }
    return frames / seconds;
}"""


def main(obstacles: int = _OBSTACLES) -> None:
    """Plan an example among obstacles, play it repeatedly and print the rate."""
    request = example("lines_panda")
    request["scene"] = {
        "obstacles": [
            {
                "name": f"post {i}",
                "shape": {"type": "cylinder", "radius": 0.03, "length": 0.4},
                "position": [-0.6 + 0.06 * i, 0.8 if i % 2 else -0.8, 0.2],
            }
            for i in range(obstacles)
        ]
    }
    with served(Settings(workers=1)) as address, chromium() as browser:
        visit = Visit(browser, address, width=1280, height=800, dark=False)
        page = visit.open("lines_panda", meshes=True)
        write(page, request)
        page.wait_for_selector(f"#stage[data-obstacles='{obstacles}']")
        plan(page)
        page.wait_for_selector("#plots[data-series=ready]")
        still = page.evaluate(_COUNT, _MEASURE_S)
        page.check("#loop")
        page.click("#play")
        playing = page.evaluate(_COUNT, _MEASURE_S)
        page.set_viewport_size({"width": 760, "height": 560})
        small = page.evaluate(_COUNT, _MEASURE_S)
        visit.close()
    sys.stdout.write(
        f"{obstacles} obstacles: {still:.0f} frames/s at rest, {playing:.0f} playing, "
        f"{small:.0f} playing in a window of 760 x 560\n"
    )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
