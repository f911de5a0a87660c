"""The planning service: ``uvicorn --factory ikplan_api.app:create_app``, or ``ikplan serve``."""
