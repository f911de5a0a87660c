"""Plan jobs: requests that are planned once, stored, watched and cancelled."""
